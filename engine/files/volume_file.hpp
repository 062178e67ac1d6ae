// SPDX-License-Identifier: Apache-2.0
// engine/files/volume_file.hpp: reads volumes from files of any format, and writes them.
//
// The suffix chooses the format of a written file: NRRD, NIfTI (also gzipped), MetaImage or OpenVDB. loadVolume reads
// the file back with the same densities, bit for bit, unless roundedByWriting() counts some. The lattice comes back to
// the rounding of the format's numbers: 32-bit floats in NIfTI, 64-bit in the others.
//
// Values are written as float32. Formats other than OpenVDB use int16 instead if the volume came from a file of
// integers and every density is a whole number that an int16 holds. NIfTI is turned from LPS to RAS. In OpenVDB a level
// set stays a level set: a signed distance with an active narrow band. An OpenVDB file names its domain
// ("palpate_domain"), since active voxels do not tell it.
//
// Thread: any, while nobody changes the volume. Memory for writing: eight slices. For OpenVDB: a copy of the stored
// bricks if the volume is a level set or its size is not a multiple of 8. Cost: one pass, or two if values may be
// int16.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/byte_sink.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

enum class LengthUnit { kMillimetre, kMetre };  // of coordinates in a file

// Loads any volume that Palpate knows: a file, a DICOM folder, or "phantom:NAME?key=value&...". volume_name.hpp says
// what a name may add. Throws Error with the input, the reason and the remedy, also for a volume that needs more than
// `memory_budget_bytes` (0: what the machine has free).
[[nodiscard]] Volume loadVolume(const std::string& name, std::size_t memory_budget_bytes = 0);

// Whether a volume is written in a file of this name: whether it ends with one of the suffixes, in any letter case.
[[nodiscard]] bool isVolumeFileName(const std::string& name);
// ".vdb, .nii, .nii.gz, .nrrd, .mha"
[[nodiscard]] const std::string& volumeFileSuffixes();

// `unit`: of OpenVDB files only; the other formats are in millimetres by custom. Empty: millimetres, but metres for a
// level set, whose values are lengths too and keep their bits only in metres. Throws Error(kBadInput) for another
// suffix, a unit that the format does not have, more voxels along an axis than NIfTI can count, and voxels that are too
// small for OpenVDB in that unit.
void writeVolume(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit, const ByteSink& sink);

// What writeVolume() would round, at most in a level set's .vdb: its values are distances in the file's unit, and a
// distance in metres times 1000 may be no float. `most` is in the file's unit. Cost: nothing, or a pass over the
// bricks.
[[nodiscard]] Rounding roundedByWriting(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit);

// Writes a file by writeVolume, whole or not at all (base/atomic_file.hpp), and returns its size [byte]. Throws as
// these two do; a file of that name then stays as it was.
std::uint64_t saveVolume(const Volume& volume, const std::string& name);

// Throws Error(kBadInput) if a file `out` would replace the volume `in` (a name for loadVolume) or a file of its
// folder, under whatever name, path or link. Call it before anything is written.
void checkNotInput(const std::string& in, const std::string& out);

}  // namespace palpate
