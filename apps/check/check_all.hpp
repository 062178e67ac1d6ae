// SPDX-License-Identifier: Apache-2.0
// apps/check/check_all.hpp: `palpate check all`: compares gradients, filters and edits with their CPU twins, on one
// volume or on a list of small ones, as the twins are slow. Thread: one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/check/check.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

struct CheckAllRequest {
  std::string gpu = {};     // part of the device's name
  std::string volume = {};  // empty: checkedVolumes
  bool quick = false;       // fewer volumes, one set of parameters for each filter, fewer edits
  int crop = 0;       // longest side; larger volumes are cut to their middle [voxel]; 0: kScanCrop for a list's scans
  unsigned seed = 1;  // of edits
};

inline constexpr int kScanCrop = 40;  // [voxel]

// The names of the volumes in the list: every phantom, with noise, at sizes that are no multiple of a brick and with
// voxels that are no cubes; random bits with denormals, +-1e-30, +-1e30 and both zeros; volumes one voxel thin along
// each axis; and the scans in the folder that the environment variable PALPATE_DATA names.
[[nodiscard]] std::vector<std::string> checkedVolumes(bool quick);

// The middle of a volume, with no side longer than `most` [voxel]; the volume itself if none is longer. The source
// of a cut volume says so.
[[nodiscard]] Volume cropped(Volume volume, int most);

// Checks every gradient operator, with samples as floats and as halves, for the volume's default isovalue.
[[nodiscard]] std::vector<Check> checkGradients(const Volume& volume, const std::string& gpu,
                                                const std::function<void(double)>& progress);

struct CheckAll {
  std::vector<Check> checks;
  std::vector<std::string> left_out;  // what could not be checked, and why
};

// `stage` gets the name of each volume as its turn comes, `progress` the fraction of it that is done. Both may throw to
// cancel. `load` gives a volume by its name.
[[nodiscard]] CheckAll checkAll(const CheckAllRequest& request, const std::function<void(const std::string&)>& stage,
                                const std::function<void(double)>& progress,
                                const std::function<Volume(const std::string&)>& load);

}  // namespace palpate
