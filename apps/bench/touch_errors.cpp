// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/touch_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/sampled/window_follower.hpp"
#include "base/units.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

Vec3 exactForce(const ContactPath& path, std::size_t k) {
  return kBenchStiffness_N_per_m * std::max(0.0, path.depth_m[k]) * path.normal_W[k];
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Column<TouchErrors> percentile(const char* key, Percentiles TouchErrors::*of, double Percentiles::*figure,
                               const Look& look = {}) {
  return {key, [of, figure](const TouchErrors& e) { return (e.*of).count > 0 ? (e.*of).*figure : kNone; }, look};
}

}  // namespace

double angleBetween_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRadian;
}

TouchTally::TouchTally(const Phantom& phantom, const ContactPath& path, const AlgorithmTraits& traits,
                       double miss_depth_voxel)
    : phantom_(phantom),
      path_(path),
      traits_(traits),
      voxel_m_(phantom.lattice().smallestSpacing()),
      miss_depth_m_(miss_depth_voxel * voxel_m_) {}

void TouchTally::add(std::size_t k, const TickOutput& out) {
  const bool contact = hasContact(out);
  if (k >= path_.slide_begin) addSlide(k, out, contact);
  const bool missed = !contact && path_.depth_m[k] > miss_depth_m_;
  if (missed && !missing_) ++errors_.falls;
  errors_.missed_ticks += missed ? 1 : 0;
  errors_.fading_ticks += (out.faults & kFadingFaults) != 0 ? 1 : 0;
  missing_ = missed;
  last_force_W_ = out.force_W;
}

TouchErrors TouchTally::taken() {
  errors_.vhip_voxel = percentiles(std::move(vhip_voxel_));
  errors_.force_percent = percentiles(std::move(force_percent_));
  errors_.angle_deg = percentiles(std::move(angle_deg_));
  errors_.force_mean_N = errors_.contact_ticks > 0 ? force_sum_N_ / static_cast<double>(errors_.contact_ticks) : 0;
  if (!traits_.shows_surface) {
    errors_.vhip_voxel = errors_.force_percent = Percentiles{};
    errors_.force_off_max = 0;
  }
  return errors_;
}

// Whether the surface is concave along the last step: its normal turns against the step.
bool TouchTally::concave(std::size_t k) const {
  return (path_.normal_W[k] - path_.normal_W[k - 1]).dot(path_.hip_W[k] - path_.hip_W[k - 1]) < 0;
}

void TouchTally::addSlide(std::size_t k, const TickOutput& out, bool contact) {
  ++errors_.ticks;
  if (k > path_.slide_begin) {
    const double jump_N = (out.force_W - last_force_W_).norm();
    errors_.force_jump_max_N = std::max(errors_.force_jump_max_N, jump_N);
    if (concave(k)) errors_.force_jump_concave_max_N = std::max(errors_.force_jump_concave_max_N, jump_N);
    errors_.exact_force_jump_max_N =
        std::max(errors_.exact_force_jump_max_N, (exactForce(path_, k) - exactForce(path_, k - 1)).norm());
  }
  if (!contact) return;
  ++errors_.contact_ticks;
  const double force_N = out.force_W.norm();
  force_sum_N_ += force_N;
  if (traits_.shows_surface) vhip_voxel_.push_back(std::abs(phantom_.signedDistance_m(out.vhip_W)) / voxel_m_);
  if (path_.exact[k] == 0 || force_N == 0) return;
  const double exact_N = kBenchStiffness_N_per_m * path_.depth_m[k];
  force_percent_.push_back(100 * std::abs(force_N - exact_N) / exact_N);
  errors_.force_off_max = std::max({errors_.force_off_max, force_N / exact_N, exact_N / force_N});
  angle_deg_.push_back(angleBetween_deg(out.force_W, path_.normal_W[k]));
}

const Columns<TouchErrors>& errorColumns() {
  using E = TouchErrors;
  using P = Percentiles;
  static const Columns<E> kColumns = {
      {"ticks", &E::ticks},
      {"contact_ticks", &E::contact_ticks},
      percentile("vhip_error_median_voxel", &E::vhip_voxel, &P::p50, {"VHIP", "voxel", 4}),
      percentile("vhip_error_p99_voxel", &E::vhip_voxel, &P::p99, {"p99", "voxel", 4}),
      percentile("force_error_median_percent", &E::force_percent, &P::p50, {"force", "%", 3}),
      percentile("force_error_p99_percent", &E::force_percent, &P::p99, {"p99", "%", 3}),
      {"force_off_max", [](const E& e) { return e.force_percent.count > 0 ? e.force_off_max : kNone; }},
      percentile("force_angle_median_deg", &E::angle_deg, &P::p50, {"angle", "deg", 2}),
      percentile("force_angle_p99_deg", &E::angle_deg, &P::p99, {"p99", "deg", 2}),
      percentile("force_angle_max_deg", &E::angle_deg, &P::max),
      {"force_jump_max_N", &E::force_jump_max_N, {"jump", "N", 3}},
      {"exact_force_jump_max_N", &E::exact_force_jump_max_N},
      {"missed_ticks", &E::missed_ticks},
      {"fading_fault_ticks", &E::fading_ticks},
      {"fall_throughs", &E::falls, {"falls", ""}}};
  return kColumns;
}

std::vector<TouchErrors> touchErrors(const BenchVolume& volume, const ContactPath& path, std::span<Entrant> entrants,
                                     const BenchProgress& progress, double miss_depth_voxel) {
  constexpr std::size_t kProgressTicks = 500;
  std::vector<TouchTally> tallies;
  std::vector<WindowFollower> followers;
  std::vector<TickOutput> outs(entrants.size());
  tallies.reserve(entrants.size());
  for (Entrant& entrant : entrants) {
    entrant.haptic->reset(path.hip_W.front());
    tallies.emplace_back(volume.phantom(), path, entrant.traits, miss_depth_voxel);
    followers.emplace_back(volume);
  }
  for (std::size_t k = 0; k < path.ticks(); ++k) {
    if (k % kProgressTicks == 0) progress(static_cast<double>(k) / static_cast<double>(path.ticks()));
    for (std::size_t e = 0; e < entrants.size(); ++e) {
      TickOutput& out = outs[e];
      const SampleWindow& window = followers[e].around(windowPlace(out, path.hip_W[k]));
      entrants[e].haptic->tick({path.hip_W[k], path.velocity_W[k], &window}, out);
      tallies[e].add(k, out);
    }
  }
  std::vector<TouchErrors> errors;
  for (TouchTally& tally : tallies) errors.push_back(tally.taken());
  return errors;
}

}  // namespace palpate
