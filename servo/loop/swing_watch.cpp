// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/swing_watch.hpp"

#include <algorithm>
#include <cmath>

#include "servo/loop/run_figures.hpp"
#include "servo/safety/faults.hpp"
#include "servo/safety/passivity.hpp"

namespace palpate {
namespace {

// How far effects move the VHIP out of the surface, along the normal.
double effectHeight(const TickRecord& record) noexcept {
  return asVec3(record.normal_W).dot(asVec3(record.vhip_W) - surfacePointOf(record));
}

}  // namespace

SwingWatch::SwingWatch(double resolution_m, const Path* path) noexcept
    : resolution_m_(resolution_m),
      least_m_(std::max(kLeastSwing_m, kLeastSwing_steps * resolution_m)),
      path_(path),
      turns_{} {}

bool SwingWatch::add(const TickRecord& now) noexcept {
  const Vec3 hip_W = asVec3(now.hip_W), surface_W = surfacePointOf(now), normal_W = asVec3(now.normal_W);
  const Vec3 path_W = path_ != nullptr ? path_->position(now.time_s) : hip_W;
  const bool contact = now.in_contact && !normal_W.isZero(0);
  if (has_plane_) {
    const double path_m = path_ != nullptr ? std::abs(normal_W_.dot(path_W - path_before_W_)) : 0;
    path_m_ += path_m;
    asked_m_ += path_m;
    if (contact) asked_m_ += std::abs(normal_W_.dot(surface_W - plane_W_)) + effectMotion(now);
  }
  path_before_W_ = path_W;
  if ((now.faults & kFadingFaults) != 0) {
    forget();
    return false;
  }
  if (contact) {
    plane_W_ = surface_W;
    normal_W_ = normal_W;
    effect_height_m_ = effectHeight(now);
    depth_m_ = now.depth_m;
    has_plane_ = true;
    left_s_ = now.time_s;
  }
  if (!has_plane_) return false;
  const double height_m = normal_W_.dot(hip_W - plane_W_);
  if (in_contact_ && !contact) countBounce(height_m, normal_W_.dot(path_W - plane_W_));
  in_contact_ = contact;
  const bool surface_ended = !contact && height_m < -least_m_;
  if (surface_ended || now.time_s - left_s_ > kLongestFlight_s) {
    forget();
    return false;
  }
  return follow({now.time_s, height_m, now.energy_J, path_m_, asked_m_, bounces_});
}

double SwingWatch::leastFelt(double hz) noexcept {
  constexpr double kBend_hz = 40, kBend_m = 10e-6, kBest_hz = 250;
  const double at = std::min(hz, kBest_hz) / kBend_hz;
  return 2 * kBend_m / (at < 1 ? std::sqrt(at) : at * at);
}

// The change of the effects' height since the last tick in contact, without the part that is in proportion to the
// depth.
double SwingWatch::effectMotion(const TickRecord& now) const noexcept {
  const double in_proportion_m = depth_m_ > 0 ? effect_height_m_ * now.depth_m / depth_m_ : 0;
  return std::min(std::abs(effectHeight(now) - effect_height_m_), std::abs(effectHeight(now) - in_proportion_m));
}

void SwingWatch::forget() noexcept {
  has_plane_ = in_contact_ = turned_ = false;
  direction_ = 0;
  count_ = 0;
}

// A bounce: contact is left outwards while the path is inside. An unknown path is taken to be where the tool is.
void SwingWatch::countBounce(double height_m, double path_height_m) noexcept {
  if (height_m >= 0 && path_height_m < -2 * resolution_m_) ++bounces_;
}

// Finds turns of the height. Changes below the least swing make no turn.
bool SwingWatch::follow(const Turn& now) noexcept {
  if (direction_ == 0) {
    direction_ = 1;
    farthest_ = now;
    return false;
  }
  if (direction_ * (now.height_m - farthest_.height_m) >= 0) {
    farthest_ = now;
    return false;
  }
  if (!(std::abs(now.height_m - farthest_.height_m) > least_m_)) return false;
  if (turned_) keep(farthest_);  // the first one may be where the record begins, not a turn
  turned_ = true;
  direction_ = -direction_;
  farthest_ = now;
  return judge();
}

void SwingWatch::keep(const Turn& turn) noexcept {
  turns_[(oldest_ + count_) % turns_.size()] = turn;
  if (count_ < turns_.size()) {
    ++count_;
  } else {
    oldest_ = (oldest_ + 1) % turns_.size();
  }
}

// Height of the swing from one turn to the next [m].
double SwingWatch::swing(std::size_t i) const noexcept {
  return std::abs(turn(i + 1).height_m - turn(i).height_m);
}

bool SwingWatch::keepsUp() const noexcept {
  for (std::size_t i = 0; i < kSwings; ++i) {
    if (turn(i + 1).time_s - turn(i).time_s > 1 / kHand_hz) return false;
    if (i >= 2 && swing(i) < kKept * swing(i - 2)) return false;
  }
  return true;
}

// No hand makes each swing at least as high as the one before it in the same direction, and all periods alike.
bool SwingWatch::growsEvenly() const noexcept {
  const double period_s = 2 * (turn(kSwings).time_s - turn(0).time_s) / kSwings;
  for (std::size_t i = 2; i <= kSwings; ++i) {
    if (std::abs(turn(i).time_s - turn(i - 2).time_s - period_s) > kUneven * period_s) return false;
    if (i < kSwings && swing(i) < swing(i - 2)) return false;
  }
  return usualSwings(kSwings / 2) >= kGrown * usualSwings(0);
}

// The sum of half of the swings, without the largest: a tool that leaves the surface makes one large swing.
double SwingWatch::usualSwings(std::size_t from) const noexcept {
  double sum_m = 0, largest_m = 0;
  for (std::size_t i = from; i < from + kSwings / 2; ++i) {
    sum_m += swing(i);
    largest_m = std::max(largest_m, swing(i));
  }
  return sum_m - largest_m;
}

bool SwingWatch::judge() noexcept {
  if (count_ <= kSwings) return false;
  double first_m = 0, last_m = 0;
  for (std::size_t i = 0; i < kSwings; ++i) (i < kSwings / 2 ? first_m : last_m) += swing(i);
  const Turn &begin = turn(0), &end = turn(kSwings);
  constexpr int kPeriods = kSwings / 2;
  const double hz = kPeriods / (end.time_s - begin.time_s);
  const bool sustained = usualSwings(kSwings / 2) >= kSustained * usualSwings(0);
  const double swings_m = first_m + last_m, path_m = end.path_m - begin.path_m;
  const double surface_m = end.asked_m - begin.asked_m - path_m;
  const bool unasked = swings_m > kUnasked * path_m + kAnswered * surface_m &&
                       (path_ != nullptr || (hz > kHand_hz && keepsUp()) || growsEvenly());
  const bool bounced = end.bounces - begin.bounces >= kPeriods && swings_m > kUnasked * path_m;
  const bool fed = end.energy_J < begin.energy_J - Passivity::kRounding_J;
  const bool felt = last_m / kPeriods >= leastFelt(hz);
  if (!sustained || !(unasked || bounced) || !fed || !felt) return false;
  unstable_ = {begin.time_s, end.time_s, swings_m / kSwings, hz};
  return true;
}

}  // namespace palpate
