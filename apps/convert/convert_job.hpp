// SPDX-License-Identifier: Apache-2.0
// apps/convert/convert_job.hpp: `palpate convert`: a volume written in another format, or its isosurface as a mesh.
//
// The file is there whole or not at all (base/atomic_file.hpp). Formats: engine/volume/volume_file.hpp,
// apps/mesh/mesh_writer.hpp. One thread. Cost: loading, and one pass over the volume; a mesh some 0.1 us a voxel near
// the surface.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/console/progress.hpp"
#include "base/atomic_file.hpp"
#include "base/vec.hpp"
#include "engine/volume/volume_file.hpp"

namespace palpate {

struct ConvertRequest {
  std::string in;                         // as loadVolume takes it
  std::string out;                        // its suffix names the format
  std::optional<double> isovalue = {};    // meshes; empty: as `palpate touch` chooses it [density]
  std::optional<double> adaptivity = {};  // meshes, [0, 1]; empty: 0 [-]
  std::optional<LengthUnit> unit = {};    // meshes and OpenVDB; empty: millimetres, metres for a level set
};

struct ConvertResult {
  Vec3i size = Vec3i::Zero();  // of the volume [voxel]
  std::size_t triangles = 0;   // of a mesh
  std::size_t vertices = 0;
  double isovalue = 0;      // of a mesh [density]
  std::uint64_t bytes = 0;  // of the file
  double seconds = 0;       // loading and all
  bool is_mesh = false;
};

// Throws Error: kBadInput for an unknown suffix, an option that the format does not have, an adaptivity outside [0, 1],
// an isovalue that gives no surface, an output that is the input or lies in the input's folder already; kIo for a
// folder that may not be written and a full disk; and what loadVolume and writeVolume throw. What was at `out` stays
// then.
[[nodiscard]] ConvertResult convert(const ConvertRequest& request, Progress& progress);

// Its parts, for verbs that write a volume which they have made. checkOutput() refuses (Error kBadInput) an output that
// is the input (checkNotInput), and what convert() refuses of a request's suffix and options. writeOutput() leaves
// commit() to the caller; `work` names the verb that Ctrl-C stops.
void checkOutput(const ConvertRequest& request);
[[nodiscard]] ConvertResult writeOutput(const Volume& volume, const ConvertRequest& request, const std::string& work,
                                        AtomicFile& file, Progress& progress);

// "knot.stl: 3120 triangles, 1562 vertices, isosurface 0 of 64 x 64 x 64 voxels, 156 kB, 0.21 s"
[[nodiscard]] std::string convertWords(const ConvertRequest& request, const ConvertResult& result);

// What becomes of a surface's isovalue in a volume's file: a line for the user; empty for a mesh.
[[nodiscard]] std::string surfaceWords(const std::string& out, double isovalue);

}  // namespace palpate
