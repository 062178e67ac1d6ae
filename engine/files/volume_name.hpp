// SPDX-License-Identifier: Apache-2.0
// engine/files/volume_name.hpp: what a volume's name may say besides its file or folder: which part of it is meant,
// which density replaces values that are NaN, infinite or too large for a float, and that tilted slices be resampled.
//
//   scan.vdb#density   folder#2   folder#1.2.3   scan.nrrd?nan=-1024   folder#2?nan=0   folder?nan=0&resample
//
// A journal keeps the name, so it loads the same volume again. A file whose own name contains these characters is found
// too. Any thread.
#pragma once

#include <optional>
#include <string>

namespace palpate {

struct VolumeName {
  std::string path;                     // the file or folder; of a phantom, the whole name
  std::string part;                     // after '#': a grid's name, a series' number or UID; empty: none
  std::optional<float> instead_of_nan;  // after "?nan=" or "&nan="
  bool resample = false;                // after "?resample" or "&resample"
  bool has_query = false;               // any of the two
  // Without what is after '?'.
  [[nodiscard]] std::string withPart() const { return part.empty() ? path : path + '#' + part; }
};

// Throws Error(kBadInput) if "nan=" is followed by anything but a finite number that a float can hold, and for anything
// else than these two behind "?nan=" or "?resample".
[[nodiscard]] VolumeName parseVolumeName(const std::string& name);

// The name of one series of a DICOM folder. `series`: its UID, or its number in the list that loadVolume gives in its
// Error when a series must be chosen. Throws Error(kBadInput) if there is no such folder, or if the name already names
// a series.
[[nodiscard]] std::string withSeries(const std::string& folder, const std::string& series);

// The name of the same volume with "?resample", if it has not got it. Throws Error(kBadInput) for a phantom.
[[nodiscard]] std::string withResample(const std::string& name);

// The name of the same volume with "?nan=VALUE". Throws Error(kBadInput) for a phantom, for a name that already has it,
// and as parseVolumeName does.
[[nodiscard]] std::string withNan(const std::string& name, const std::string& value);

}  // namespace palpate
