// SPDX-License-Identifier: Apache-2.0
// apps/check/filter_check.hpp: compares filters on the GPU with their CPU twins, step by step. The twin of each step
// gets the GPU's result of the step before, so that a difference is found where it arises. Then the chain as a whole is
// compared with its steps. Thread: one.
//
// Cost: mainly the twin's, which goes voxel by voxel: about a second for the whole list on 64^3 voxels. Memory: three
// fields on the GPU, four on the host.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/check/check.hpp"
#include "engine/field/volume.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

struct FilterCheckRequest {
  std::string gpu = {};                          // part of the device's name
  std::vector<std::string> chains = {};          // as --filter takes them; empty: checkedFilters
  std::optional<float> isovalue = std::nullopt;  // for distances; empty: the volume's default
};

// Chains for checkFilters: each filter of the table with two sets of parameters, both borders where it has them, sizes
// in voxels and in mm, and ranges and slopes that suit the volume. `short_list`: one set of parameters for each.
[[nodiscard]] std::vector<std::string> checkedFilters(const Volume& volume, bool short_list = false);
// Removes the chains with a distance, for a volume without a surface.
void dropDistances(std::vector<std::string>& chains);

// A check for each step, and one for each chain of several steps. The steps of a distance count as one; each distance
// also has a check named "distance", against brute force (distance_bounds.hpp). `progress` gets the fraction done,
// often, and may throw to cancel. Throws Error as lowerFilters and FilterChain do.
[[nodiscard]] std::vector<Check> checkFilters(const Volume& volume, const FilterCheckRequest& request,
                                              const std::function<void(double)>& progress);

// The same, with a separate field for the twin of the first step, so that a test can make the two sides differ.
[[nodiscard]] std::vector<Check> checkFilters(const Volume& volume, const reference::DenseField& field,
                                              const FilterCheckRequest& request,
                                              const std::function<void(double)>& progress);

}  // namespace palpate
