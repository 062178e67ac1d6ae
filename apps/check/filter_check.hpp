// SPDX-License-Identifier: Apache-2.0
// apps/check/filter_check.hpp: every filter on the GPU against its CPU twin, step by step: each step of a chain is
// compared for what the GPU made of the step before, so that a difference is found where it arises; then the chain as a
// whole against its steps. Thread: one.
//
// Cost: the twin's, which goes voxel by voxel: on 64^3 voxels a second or so for the whole list. Memory: on the GPU
// three fields, here four.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/check/check.hpp"
#include "engine/reference/dense_field.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct FilterCheckRequest {
  std::string gpu = {};                          // part of the device's name
  std::vector<std::string> chains = {};          // as --filter takes them; empty: checkedFilters
  std::optional<float> isovalue = std::nullopt;  // of distances; none: the volume's default
};

// Each filter of the table with two sets of parameters, both borders where it has them, sizes in voxels and in
// millimetres; ranges and slopes that suit the volume. `short_list`: one of each.
[[nodiscard]] std::vector<std::string> checkedFilters(const Volume& volume, bool short_list = false);
// Takes the chains with a distance out, for a volume without a surface.
void dropDistances(std::vector<std::string>& chains);

// A check a step, and one for each chain of several. Steps of a distance count as one, and a distance has a check of
// its own besides, named "distance": against brute force (distance_bounds.hpp). `progress` gets the fraction done, and
// may throw to cancel: asked often. Throws Error as lowerFilters and FilterChain do.
[[nodiscard]] std::vector<Check> checkFilters(const Volume& volume, const FilterCheckRequest& request,
                                              const std::function<void(double)>& progress);

// The same with the field that the twin reads first given apart, so that a test can make the two sides differ.
[[nodiscard]] std::vector<Check> checkFilters(const Volume& volume, const reference::DenseField& field,
                                              const FilterCheckRequest& request,
                                              const std::function<void(double)>& progress);

}  // namespace palpate
