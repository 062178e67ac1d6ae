// SPDX-License-Identifier: Apache-2.0
// apps/load/stair_words.hpp: what a user should know of a volume of few values (engine/field/few_values.hpp): that its
// surface is felt as stairs, and what helps. docs/masks.md tells the whole; `palpate bench masks` measured it.
//
// Set-up code, any thread. Cost: where a volume is looked at, fewValuesOf().
#pragma once

#include <string>
#include <vector>

#include "engine/field/volume.hpp"
#include "engine/plan/plan.hpp"

namespace palpate {

// What makes a surface of a mask's stairs. Its size is in voxels along each axis, since stairs are as high as voxels
// are: across slices of 3 mm 1.5 mm is half a voxel, and leaves them.
inline constexpr const char* kStairFilter = "gaussian:1.5";
// Filter and gradient operator that together smooth normals as well, and remove less. Not every program has both.
inline constexpr const char* kGentleFilter = "gaussian:1";
inline constexpr const char* kGentleGradient = "gaussian:1";

// How the program that says it gets filters.
enum class FilterGiven {
  kAsOption,  // --filter
  kAsFile     // it has no filters: the volume is filtered beforehand
};

// What a look at a volume found. That it is a mask or a map of labels does not depend on the isovalue. So one look, at
// any isovalue that parts the volume, has the words for others, also once the volume may not be read any more.
struct Stairs {
  std::vector<float> values;  // FewValues::values; empty: nothing is to be said of the volume
  Vec3 spacing_m = Vec3::Zero();
};
[[nodiscard]] Stairs stairsOf(const Volume& volume, double isovalue);

// One sentence or two, without the volume's name; "" where nothing is to be said: the volume has many values, it is a
// mask that the plan smooths (smoothsStairs), or the isovalue does not part it.
[[nodiscard]] std::string stairWords(const Stairs& stairs, double isovalue, const Plan& plan, FilterGiven given);
[[nodiscard]] std::string stairWords(const Volume& volume, double isovalue, const Plan& plan, FilterGiven given);

// Whether normals are smooth through a plan: the Gaussians of its filters and of its gradient operator together have a
// sigma of a voxel or more along each axis, or it has a diffusion, or a bilateral filter whose range is `contrast` or
// more. All else gives values that were there before, or the distance from the same stairs. With less than a voxel more
// than half of the stairs is left.
inline constexpr double kLeastSmoothing_voxel = 1;
[[nodiscard]] bool smoothsStairs(const Plan& plan, const Vec3& spacing_m, double contrast);

}  // namespace palpate
