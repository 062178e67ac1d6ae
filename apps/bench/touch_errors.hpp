// SPDX-License-Identifier: Apache-2.0
// apps/bench/touch_errors.hpp: the errors of algorithms against the exact surface, along a path.
//
// All algorithms follow the path in step. Each has a window that follows as in the program (windowPlace).
//
// Over the ticks of the slide in contact (the algorithm's flag, or a force):
//   VHIP [voxel]      distance of the VHIP from the exact surface, in smallest voxels
//   force [%]         | |F| - K depth | / (K depth), with the depth of the HIP below the exact surface
//   force off [-]     the largest |F| / (K depth) or its inverse, whichever is more
//   angle [degree]    between the force and the exact normal at the surface point nearest to the HIP
// Over all ticks of the slide:
//   force jump [N]    largest change of the force vector from one tick to the next
// Over all ticks:
//   missed            ticks without contact in which the HIP is more than `miss_depth` below the exact surface
//   falls             how often such a stretch of ticks began
//   fading            ticks with a fault that makes the gate fade the force, whatever the algorithm's force
//
// An algorithm that shows no surface (AlgorithmTraits) has no errors of VHIP and force. Force and angle leave out ticks
// where the phantom's distance is only a bound (ContactPath::exact). Cost: one exact distance for each algorithm and
// tick.
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

// Noise moves the surface of the samples. Four of its standard deviations deeper, only one sample in 30,000 is not
// object.
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
  double force_jump_concave_max_N = 0;  // largest jump where the exact surface is concave along the path
  double exact_force_jump_max_N = 0;    // of K * depth along the exact normal, for comparison
  double force_mean_N = 0;              // mean |F| over ticks in contact
  std::int64_t missed_ticks = 0;
  std::int64_t falls = 0;
  std::int64_t fading_ticks = 0;  // with one of kFadingFaults
};

using BenchProgress = std::function<void(double share_done)>;  // may throw to stop

[[nodiscard]] inline bool hasContact(const TickOutput& out) noexcept {
  return out.in_contact || out.force_W.squaredNorm() > 0;
}

// By atan2, since acos alone is inaccurate for small angles.
[[nodiscard]] double angleBetween_deg(const Vec3& a, const Vec3& b);

// Adds up the errors of one algorithm, tick by tick. `phantom` and `path` outlive it.
class TouchTally {
 public:
  TouchTally(const Phantom& phantom, const ContactPath& path, const AlgorithmTraits& traits,
             double miss_depth_voxel = kMissDepth_voxel);
  void add(std::size_t k, const TickOutput& out);  // the output of tick k of the path
  [[nodiscard]] TouchErrors taken();               // once, after the last tick

 private:
  [[nodiscard]] bool concave(std::size_t k) const;
  void addSlide(std::size_t k, const TickOutput& out, bool contact);

  const Phantom& phantom_;
  const ContactPath& path_;
  AlgorithmTraits traits_;
  double voxel_m_, miss_depth_m_;
  TouchErrors errors_;
  std::vector<double> vhip_voxel_, force_percent_, angle_deg_;
  double force_sum_N_ = 0;
  Vec3 last_force_W_ = Vec3::Zero();
  bool missing_ = false;
};

// A figure without data (no contact, or an algorithm that shows no surface) is NaN.
[[nodiscard]] const Columns<TouchErrors>& errorColumns();

// One result for each entrant.
[[nodiscard]] std::vector<TouchErrors> touchErrors(const BenchVolume& volume, const ContactPath& path,
                                                   std::span<Entrant> entrants, const BenchProgress& progress,
                                                   double miss_depth_voxel = kMissDepth_voxel);

}  // namespace palpate
