// SPDX-License-Identifier: Apache-2.0
// engine/filter/filter_step.hpp: lowers filters to steps. A step is one pass of one kernel over bricks. Its numbers are
// in voxels and rounded to float once, so that kernel and twin use the same ones. Any thread.
#pragma once

#include <span>
#include <vector>

#include "base/vec.hpp"
#include "engine/filter/filter_spec.hpp"

namespace palpate {

enum class StepKind {
  kConvolve,       // along one axis, with symmetric taps
  kBilateral,      // mean over a box, weighted by distance and by difference of density
  kDiffuse,        // one time step of anisotropic diffusion
  kMedian,         // middle value of the box of `reach`
  kHighestOnLine,  // highest value within reach along one axis
  kLowestOnLine,   // lowest value within reach along one axis
  kHighestInRows,  // highest value in the rows of the shape
  kLowestInRows,   // lowest value in the rows of the shape
  // The parts of a distance, in this order: seed, a spread along each axis, finish. Between them a pool holds encoded
  // surface points (shaders/filter_distance.layout.h) instead of densities.
  kDistanceSeed,    // of each voxel, the nearest surface point on the lines to its 26 neighbours
  kDistanceSpread,  // along one axis: the nearest of the surface points of the voxels within reach
  kDistanceFinish   // distance from the tangent plane at that point; reads the densities that the seed step read
};

// One row of a shape: the voxels from (-half, dj, dk) to (half, dj, dk), relative to the middle [voxel].
struct ShapeRow {
  int dj = 0, dk = 0, half = 0;
};

struct FilterStep {
  StepKind kind = StepKind::kConvolve;
  int axis = 0;                 // of a step along one axis
  Vec3i reach = Vec3i::Zero();  // how far a result depends on voxels, along each axis, either way [voxel]
  Border border = Border::kNearest;
  // Parameters, by kind. convolve: weights w(0) ... w(reach). bilateral: 1 / (sqrt(2) range), then the weights w(0) ...
  // w(reach) of each axis. diffuse: time step / spacing^2 of each axis, then 1 / (kappa spacing) of each axis.
  // distance: the numbers of shaders/filter_distance.layout.h.
  std::vector<float> taps = {};
  std::vector<ShapeRow> rows = {};                   // of a shape, the shortest first
  Conductance conductance = Conductance::kRational;  // of a diffusion
};

// Largest reach of a step along an axis [voxel].
inline constexpr int kLargestReach = 32;          // kernels are unrolled over the reach
inline constexpr int kLargestMedian = 3;          // of a median, whose cost grows with the cube of the reach
inline constexpr int kLargestBall = 16;           // of a ball, whose cost grows with the square of the reach
inline constexpr int kLargestBilateralReach = 8;  // of a bilateral filter, whose cost grows with the cube of the reach

inline constexpr int kDistanceSteps = 5;  // steps of one distance filter

// The steps of a chain on voxels of `spacing_m`. A filter that would change nothing yields no step: a Gaussian far
// narrower than a voxel, a neighbourhood of one voxel. `isovalue`: that of the chain's input; a distance needs it.
// Throws Error(kBadInput) for a filter beyond its largest reach, a time step beyond stableTimeStep(), and a distance
// without an isovalue.
[[nodiscard]] std::vector<FilterStep> lowerFilters(std::span<const FilterSpec> filters, const Vec3& spacing_m,
                                                   std::optional<float> isovalue = std::nullopt);

// The longest stable time step of diffusion [mm^2]: 1 / (2 (1/hx^2 + 1/hy^2 + 1/hz^2)), for a conductance of at most 1.
// Up to it, every new density is a mean of the old densities around it, with weights >= 0. Only the voxel's own weight
// could be negative. It is 1 - dt * (the sum of conductance / h^2 over its six faces) >= 1 - 2 dt (1/hx^2 + 1/hy^2 +
// 1/hz^2) >= 0. So a new density never lies outside the range of the densities around it.
[[nodiscard]] double stableTimeStep(const Vec3& spacing_m) noexcept;

// Half width of the band of a distance step [m]. Distances are clamped to it.
[[nodiscard]] float distanceBand(const FilterStep& step) noexcept;

// How far the whole chain carries a change along each axis [voxel].
[[nodiscard]] Vec3i totalReach(std::span<const FilterStep> steps);

// The result of a step where the field holds `density` everywhere within reach. It equals the kernel's, bit for bit.
// For the last step of a distance it is plus or minus the band, depending on the side of the isovalue.
[[nodiscard]] float uniformResult(const FilterStep& step, float density);

}  // namespace palpate
