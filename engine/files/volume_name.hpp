// SPDX-License-Identifier: Apache-2.0
// engine/files/volume_name.hpp: what a volume's name says besides its file or folder: which part of it is meant, and
// what voxels become that are NaN, infinite or beyond the range of a float.
//
//   scan.vdb#density   folder#2   folder#1.2.3   scan.nrrd?nan=-1024   folder#2?nan=0
//
// It travels in the name, so that a journal, which keeps the name, loads the same volume again. A file whose own name
// has these characters is found under it. Any thread.
#pragma once

#include <optional>
#include <string>

namespace palpate {

struct VolumeName {
  std::string path;                     // the file or folder; of a phantom all that follows "phantom:" too
  std::string part;                     // after '#': a grid's name, a series' number or UID; empty: none
  std::optional<float> instead_of_nan;  // after "?nan="
  // Without "?nan=".
  [[nodiscard]] std::string withPart() const { return part.empty() ? path : path + '#' + part; }
};

// Throws Error(kBadInput) where "?nan=" is followed by no finite number that a float can hold, or stands at a phantom.
[[nodiscard]] VolumeName parseVolumeName(const std::string& name);

// The name of one series of a DICOM folder. `series`: its number in the list that loadVolume prints where it is not
// given, or its UID. Throws Error(kBadInput) if there is no such folder, or the name names a series already.
[[nodiscard]] std::string withSeries(const std::string& folder, const std::string& series);

// The name of the same volume with `value` for its voxels that are no densities. Throws Error(kBadInput) if the name
// says so already, and as parseVolumeName.
[[nodiscard]] std::string withNan(const std::string& name, const std::string& value);

}  // namespace palpate
