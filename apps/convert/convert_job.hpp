// SPDX-License-Identifier: Apache-2.0
// apps/convert/convert_job.hpp: `palpate convert`: writes a volume in another format, or its isosurface as a mesh.
//
// The file is there whole or not at all (base/atomic_file.hpp). Formats: engine/files/volume_file.hpp,
// apps/mesh/mesh_writer.hpp. One thread. Cost: loading, and one pass over the volume; a mesh some 0.1 us a voxel near
// the surface.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/console/progress.hpp"
#include "base/atomic_file.hpp"
#include "base/vec.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

struct ConvertRequest {
  std::string in;                         // as loadVolume takes it
  std::string out;                        // its suffix names the format
  std::optional<double> isovalue = {};    // for meshes; empty: as `palpate touch` chooses it [density]
  std::optional<double> adaptivity = {};  // for meshes, [0, 1]; empty: 0 [-]
  std::optional<LengthUnit> unit = {};    // for meshes and OpenVDB; empty: mm, but m for a level set
  bool exact = false;  // refuse a volume whose numbers are not all kept, from file to file; not for meshes
};

struct ConvertResult {
  Vec3i size = Vec3i::Zero();  // of the volume [voxel]
  std::size_t triangles = 0;   // of a mesh
  std::size_t vertices = 0;
  std::size_t collapsed = 0;  // triangles without area, once their corners are 32-bit floats
  double isovalue = 0;        // of a mesh [density]
  std::uint64_t bytes = 0;    // of the file
  double seconds = 0;         // the whole job, loading included
  bool is_mesh = false;
};

// Throws Error: kBadInput for an unknown suffix, an option that the format does not take, an adaptivity outside [0, 1],
// an isovalue that gives no surface, and an output that is the input or an existing file in the input's folder; kIo for
// a folder without write permission and for a full disk; and as loadVolume and writeVolume do. With `exact` also
// kBadInput for a number that was rounded (Rounding), replaced, clamped or resampled when it was read, and for one that
// would be rounded when it is written. Then a file that was at `out` is unchanged.
[[nodiscard]] ConvertResult convert(const ConvertRequest& request, Progress& progress);

// What `exact` promises of a volume that has been loaded. Throws Error(kBadInput) as convert() does. Cost: see
// roundedByWriting().
void checkExact(const Volume& volume, const ConvertRequest& request);

// Parts of convert(), for verbs that write a volume of their own. checkOutput() refuses (Error kBadInput) an output
// that is the input (checkNotInput), and the suffixes and options that convert() refuses. writeOutput() leaves
// `file.commit()` to the caller; `work` names the verb in the message after Ctrl-C.
void checkOutput(const ConvertRequest& request);
[[nodiscard]] ConvertResult writeOutput(const Volume& volume, const ConvertRequest& request, const std::string& work,
                                        AtomicFile& file, Progress& progress);

// "knot.stl: 3120 triangles, 1562 vertices, isosurface 0 of 64 x 64 x 64 voxels, 156 kB, 0.21 s"
[[nodiscard]] std::string convertWords(const ConvertRequest& request, const ConvertResult& result);

// A line for the user on whether the file of a volume keeps the surface's isovalue; empty for a mesh.
[[nodiscard]] std::string surfaceWords(const std::string& out, double isovalue);

}  // namespace palpate
