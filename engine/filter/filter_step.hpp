// SPDX-License-Identifier: Apache-2.0
// engine/filter/filter_step.hpp: filters lowered to steps, each one pass of one kernel over bricks: numbers in voxels,
// rounded to float once, so that kernel and twin are handed the same. Any thread.
#pragma once

#include <span>
#include <vector>

#include "base/vec.hpp"
#include "engine/filter/filter_spec.hpp"

namespace palpate {

enum class StepKind {
  kConvolve,       // along one axis, with symmetric taps
  kMedian,         // middle value of the box of `reach`
  kHighestOnLine,  // highest value within reach along one axis
  kLowestOnLine,   // lowest value within reach along one axis
  kHighestInRows,  // highest value in the rows of the shape
  kLowestInRows    // lowest value in the rows of the shape
};

// Voxels (-half, dj, dk) to (half, dj, dk) around the middle of a shape.
struct ShapeRow {
  int dj = 0, dk = 0, half = 0;
};

struct FilterStep {
  StepKind kind = StepKind::kConvolve;
  int axis = 0;                 // of a step along one axis
  Vec3i reach = Vec3i::Zero();  // a result depends on voxels so far away along each axis, either way [voxel]
  Border border = Border::kNearest;
  std::vector<float> taps;     // convolve: w(0) ... w(reach)
  std::vector<ShapeRow> rows;  // of a shape, the shortest first
};

// The largest reach of a step along an axis [voxel]: kernels are unrolled over it.
inline constexpr int kLargestReach = 32;
inline constexpr int kLargestMedian = 3;  // of a median: its work grows with the cube
inline constexpr int kLargestBall = 16;   // of a ball: its work grows with the square

// Steps of a chain on voxels of `spacing_m`. A filter that would change nothing (a Gaussian far below a voxel) gives no
// step; nor does a window that holds one voxel only. Throws Error(kBadInput) where a filter would reach farther than
// its kernel can.
[[nodiscard]] std::vector<FilterStep> lowerFilters(std::span<const FilterSpec> filters, const Vec3& spacing_m);

// How far the whole chain carries a change, along each axis [voxel].
[[nodiscard]] Vec3i totalReach(std::span<const FilterStep> steps);

// What a step makes of a field that is `density` everywhere within its reach, bit for bit as the kernel does.
[[nodiscard]] float uniformResult(const FilterStep& step, float density);

}  // namespace palpate
