// SPDX-License-Identifier: Apache-2.0
// apps/bench/touch_errors.hpp: how far algorithms are from the exact touch along a path.
//
// All of them go along the path in step, each under a window that follows as the program's does (windowPlace). Over the
// ticks of the slide in which an algorithm has contact (its flag, or a force):
//   VHIP [voxel]      distance of the VHIP from the exact surface, in smallest voxels;
//   force [%]         | |F| - K depth | / (K depth), depth of the HIP below the exact surface;
//   force off [-]     the largest |F| / (K depth), or its inverse where that is more;
//   angle [degree]    between the force and the exact normal at the surface point nearest to the HIP;
//   force jump [N]    largest change of the force vector from one tick to the next;
//   missed            ticks in which the HIP is deeper than `miss_depth` below the exact surface, having come from
//                     outside, and there is no contact; falls: how often such a stretch began.
//   fading            ticks with a fault that makes the gate take the force away, whatever the algorithm gives.
// An algorithm that shows no surface (AlgorithmTraits) has no VHIP error, and its force none against K depth.
// Force and angle leave out ticks where the phantom's distance is a bound only (ContactPath::exact). Cost: one exact
// distance for each algorithm and tick.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "apps/bench/columns.hpp"
#include "apps/bench/contact_path.hpp"
#include "apps/bench/entrants.hpp"
#include "base/quantile.hpp"

namespace palpate {

inline constexpr double kMissDepth_voxel = 0.25;

// Noise moves the surface of the samples: four of its standard deviations deeper the tool is in the object, but for one
// sample in 30,000.
[[nodiscard]] inline double missDepth_voxel(double noise_voxel) noexcept {
  return kMissDepth_voxel + 4 * noise_voxel;
}

struct TouchErrors {
  std::int64_t ticks = 0;  // of the slide
  std::int64_t contact_ticks = 0;
  Percentiles vhip_voxel;
  Percentiles force_percent;
  double force_off_max = 0;
  Percentiles angle_deg;
  double force_jump_max_N = 0;
  double force_jump_concave_max_N = 0;  // of it, where the exact surface is concave along the tool's way
  double exact_force_jump_max_N = 0;    // of K * depth along the exact normal, for comparison
  double force_mean_N = 0;              // over ticks in contact
  std::int64_t missed_ticks = 0;
  std::int64_t falls = 0;
  std::int64_t fading_ticks = 0;  // in which a fault takes the force away (kFadingFaults)
};

using BenchProgress = std::function<void(double share_done)>;  // may throw to stop

[[nodiscard]] inline bool hasContact(const TickOutput& out) noexcept {
  return out.in_contact || out.force_W.squaredNorm() > 0;
}

// As rows have them. Figures of nothing (without contact, or without a surface that is shown) are NaN.
[[nodiscard]] const Columns<TouchErrors>& errorColumns();

// One result for each entrant.
[[nodiscard]] std::vector<TouchErrors> touchErrors(const BenchVolume& volume, const ContactPath& path,
                                                   std::span<Entrant> entrants, const BenchProgress& progress,
                                                   double miss_depth_voxel = kMissDepth_voxel);

}  // namespace palpate
