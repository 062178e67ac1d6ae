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
  kBilateral,      // every voxel of a box, weighted by place and by density
  kDiffuse,        // one time step of anisotropic diffusion
  kMedian,         // middle value of the box of `reach`
  kHighestOnLine,  // highest value within reach along one axis
  kLowestOnLine,   // lowest value within reach along one axis
  kHighestInRows,  // highest value in the rows of the shape
  kLowestInRows,   // lowest value in the rows of the shape
  // The three parts of a distance, in this order: seed, spread along each axis, finish. Between them a pool holds the
  // words of shaders/filter_distance.layout.h instead of densities.
  kDistanceSeed,    // the surface point next to each voxel, found along the lines to its 26 neighbours
  kDistanceSpread,  // along one axis: of the surface points that voxels within reach know, the nearest
  kDistanceFinish   // distance from that point's tangent plane; reads the densities that the seed step read
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
  // convolve: w(0) ... w(reach). bilateral: 1 / (sqrt(2) range), then w(0) ... w(reach) of each axis. diffuse: time
  // step over spacing squared of each axis, then 1 / (kappa times spacing). distance: DISTANCE_... of
  // shaders/filter_distance.layout.h.
  std::vector<float> taps = {};
  std::vector<ShapeRow> rows = {};                   // of a shape, the shortest first
  Conductance conductance = Conductance::kRational;  // of a diffusion
};

// The largest reach of a step along an axis [voxel]: kernels are unrolled over it.
inline constexpr int kLargestReach = 32;
inline constexpr int kLargestMedian = 3;  // of a median: its work grows with the cube
inline constexpr int kLargestBall = 16;   // of a ball: its work grows with the square

// The same of a bilateral filter, whose cost grows with its cube.
inline constexpr int kLargestBilateralReach = 8;

inline constexpr int kDistanceSteps = 5;  // of one distance filter

// Steps of a chain on voxels of `spacing_m`. A filter that would change nothing (a Gaussian far below a voxel) gives no
// step; nor does a window that holds one voxel only. `isovalue`: where the object begins in what the chain is given; a
// distance needs it, and leaves it at 0 (isovalueAfter). Throws Error(kBadInput) where a filter would reach farther
// than its largest reach, where a time step is beyond stableTimeStep, and where a distance has no isovalue.
[[nodiscard]] std::vector<FilterStep> lowerFilters(std::span<const FilterSpec> filters, const Vec3& spacing_m,
                                                   std::optional<float> isovalue = std::nullopt);

// The longest stable time step of diffusion with a conductance of 1 at most [mm^2]: 1 / (2 (1/hx^2 + 1/hy^2 + 1/hz^2)).
// Up to it every new density is a mean of the old ones around it with weights that are not negative: the voxel's own is
// 1 - dt * (the sum of conductance / h^2 over its six faces) >= 1 - 2 dt (1/hx^2 + 1/hy^2 + 1/hz^2) >= 0. So no step
// makes a density that lies outside of those around it, and none can grow.
[[nodiscard]] double stableTimeStep(const Vec3& spacing_m) noexcept;

// Half width of the band that a distance step knows [m]: its result is cut off there.
[[nodiscard]] float distanceBand(const FilterStep& step) noexcept;

// How far the whole chain carries a change, along each axis [voxel].
[[nodiscard]] Vec3i totalReach(std::span<const FilterStep> steps);

// What a step makes of a field that is `density` everywhere within its reach, bit for bit as the kernel does. Of the
// steps of a distance, the last one gives plus or minus the band by the side on which `density` lies.
[[nodiscard]] float uniformResult(const FilterStep& step, float density);

}  // namespace palpate
