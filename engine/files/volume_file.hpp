// SPDX-License-Identifier: Apache-2.0
// engine/files/volume_file.hpp: volumes read from files of any format, and written as files. What writing promises: a
// file of a format that the suffix names: NRRD, NIfTI (also
// gzipped), MetaImage, OpenVDB. loadVolume reads it back with the same densities, bit for bit, and the same lattice, to
// the rounding of the format's numbers (NIfTI: 32-bit floats; the others: 64-bit).
//
// Values: float32, or int16 where the volume came from a file of integers and every density is a whole number that an
// int16 holds; OpenVDB always float32. NIfTI is turned from LPS to RAS. A level set stays one in OpenVDB: a signed
// distance, narrow band active. An OpenVDB file names its domain ("palpate_domain"), which its active voxels do not.
// Thread: any, while nobody changes the volume. Memory: eight slices; OpenVDB: a copy of the stored bricks where it is
// a level set or a side is no multiple of 8. Cost: one pass, two where the values may be int16.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/byte_sink.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

enum class LengthUnit { kMillimetre, kMetre };  // of coordinates in a file

// Loads any volume that Palpate knows: a file, a DICOM folder, or "phantom:NAME?key=value&..."; volume_name.hpp says
// what a name may add. Throws Error with the input, the reason and the remedy. `memory_budget_bytes`: refuse what would
// need more (0: what the machine has free).
[[nodiscard]] Volume loadVolume(const std::string& name, std::size_t memory_budget_bytes = 0);

// Whether the suffix is one of these formats': .nrrd .nii .nii.gz .mha .vdb, in any case.
[[nodiscard]] bool isVolumeFileName(const std::string& name);
inline constexpr const char* kVolumeFileSuffixes = ".vdb, .nii, .nii.gz, .nrrd, .mha";

// `unit`: OpenVDB only, the others are in millimetres by custom; without it millimetres, and metres for a level set,
// whose values are lengths too and keep their bits only so. Throws Error(kBadInput): another suffix; a unit that the
// format does not have; more voxels along an axis than NIfTI can count; voxels too small for OpenVDB in that unit.
void writeVolume(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit, const ByteSink& sink);

// writeVolume into a file that is there whole or not at all (base/atomic_file.hpp); returns its size [byte]. Throws as
// the two do; what was there then stays.
std::uint64_t saveVolume(const Volume& volume, const std::string& name);

// Throws Error(kBadInput) where a file `out` would replace the volume `in` (as loadVolume takes it) or a file of its
// folder, by whatever name, link or way. Call it before anything is written.
void checkNotInput(const std::string& in, const std::string& out);

}  // namespace palpate
