// SPDX-License-Identifier: Apache-2.0
// apps/check/check_all.hpp: `palpate check all`: gradients, filters and edits against their twins, on one volume or on
// a list of them that is as wide as twins are slow. Thread: one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/check/check.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct CheckAllRequest {
  std::string gpu = {};     // part of the device's name
  std::string volume = {};  // empty: checkedVolumes
  bool quick = false;       // fewer volumes, one set of parameters for each filter, fewer edits
  int crop = 0;       // longest side; what is larger is cut to its middle [voxel]; 0: kScanCrop for a list's scans
  unsigned seed = 1;  // of edits
};

inline constexpr int kScanCrop = 40;  // [voxel]

// Every phantom with noise, at sizes that are no multiple of a brick, voxels that are no cubes; random bits with
// denormals, +-1e-30, +-1e30 and both zeros; volumes one voxel thin along each axis;
// and the scans in the folder that PALPATE_DATA names.
[[nodiscard]] std::vector<std::string> checkedVolumes(bool quick);

// The middle of a volume, no side longer than `most`; the volume as it is if none is. Its source says so.
[[nodiscard]] Volume cropped(Volume volume, int most);

// Every operator of the table, samples as floats and as halves about the volume's own isovalue.
[[nodiscard]] std::vector<Check> checkGradients(const Volume& volume, const std::string& gpu,
                                                const std::function<void(double)>& progress);

struct CheckAll {
  std::vector<Check> checks;
  std::vector<std::string> left_out;  // what could not be checked, and why
};

// `stage` is told each volume's turn, `progress` the fraction of it that is done; either may throw to cancel.
[[nodiscard]] CheckAll checkAll(const CheckAllRequest& request, const std::function<void(const std::string&)>& stage,
                                const std::function<void(double)>& progress);

}  // namespace palpate
