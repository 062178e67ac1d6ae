// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/believed_counts.hpp"

#include <algorithm>
#include <cstdint>

namespace palpate {

BelievedCounts::BelievedCounts(const ArmKinematics& arm, double tick_s) noexcept
    : arm_(arm),
      tick_s_(tick_s),
      motion_(kHandMotion, arm.resolution_m(arm.anglesAt(Vec3::Zero()).value_or(Vec3(Vec3::Zero())))) {}

void BelievedCounts::take(const PolhemCounts& raw, const ArmCounts& counts) noexcept {
  raw_ = raw;
  counts_ = counts;
  angles_ = arm_.angles(counts);
  position_A_ = arm_.position(angles_);
  leaps_ = 0;
}

void BelievedCounts::countFrom(const PolhemCounts& raw) noexcept {
  take(raw, {raw[0], raw[1], raw[2]});
  motion_.begin();
}

// An encoder that turns on beyond 16 bits begins anew at the other end.
ArmCounts BelievedCounts::countsOn(const PolhemCounts& raw) const noexcept {
  ArmCounts counts = counts_;
  for (std::size_t k = 0; k < 3; ++k)
    counts[k] += static_cast<std::int16_t>(static_cast<std::uint16_t>(raw[k]) - static_cast<std::uint16_t>(raw_[k]));
  return counts;
}

// While the arm was silent it may have been anywhere, and so may its counts: that time counts for little.
double BelievedCounts::longestWay_m(const Interval& since) const noexcept {
  const double spoken_s = std::max(tick_s_, since.time_s - since.silent_s);
  return std::min(motion_.longestWay_m(since.time_s, since.waited_s),
                  motion_.longestWay_m(spoken_s, since.waited_s) + (since.silent_s > 0 ? kLongestLeap_m : 0));
}

// After a leap, what lies nearer to it than to where the handle was leaps, too, however much time has passed meanwhile.
BelievedCounts::Verdict BelievedCounts::look(const PolhemCounts& raw, const Interval& since) noexcept {
  const ArmCounts counts = countsOn(raw);
  const Vec3 at_A = arm_.position(arm_.angles(counts));
  const double way_m = (at_A - position_A_).norm();
  if (way_m <= longestWay_m(since) && (leaps_ == 0 || way_m < (at_A - leapt_to_A_).norm())) {
    motion_.believe(way_m, since.time_s, since.waited_s);
    take(raw, counts);
    return Verdict::kMotion;
  }
  leapt_to_A_ = at_A;
  if (++leaps_ < kMostLeaps) return Verdict::kLeap;
  countFrom(raw);
  return Verdict::kElsewhere;
}

}  // namespace palpate
