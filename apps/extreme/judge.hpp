// SPDX-License-Identifier: Apache-2.0
// apps/extreme/judge.hpp: holds a run against what is expected of it, by formulas that share nothing with the servo.
// World frame W [m, N]. Any thread.
#pragma once

#include <string>

#include "apps/extreme/extreme_case.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

// An exact plane of the surface: the object is behind it.
struct ExactPlane {
  Vec3 p_W = Vec3::Zero();        // [m]
  Vec3 normal_W = Vec3::UnitZ();  // unit, out of the object [-]
  [[nodiscard]] double depth_m(const Vec3& x_W) const { return (p_W - x_W).dot(normal_W); }
};

class Judge {
 public:
  // Begins with what holds for every run.
  explicit Judge(const RoughRun& run, RoughResult result);

  // In the last tenth of the run, while the hand is still: contact, and a force of K times the exact depth along the
  // exact normal. `position_m` bounds the error of the surface's place, and with it that of the force, K position_m.
  Judge& feels(const ExactPlane& plane, double position_m);
  // In the last tenth there is contact; `least_N` of force, with a share along `out_W` of at least half.
  Judge& isPushed(const Vec3& out_W, double least_N);
  Judge& feelsNothing();            // no force in any tick
  Judge& endsWithoutForce();        // the last tick's force is 0
  Judge& raises(ServoFault fault);  // in some tick
  Judge& doesNotRaise(ServoFault fault);
  Judge& raisesNoFadingFault();
  Judge& that(bool holds, const std::string& otherwise);

  [[nodiscard]] const RoughResult& result() const noexcept { return result_; }
  // With the largest force, the ticks in contact and the faults; `more` comes first.
  [[nodiscard]] ExtremeOutcome outcome(const std::string& more = "") const;

 private:
  [[nodiscard]] std::size_t lastTenth() const noexcept;  // index of its first record
  const RoughRun& run_;
  RoughResult result_;
  std::string differs_;
};

// The outcome of work that must be refused with words that contain `words`.
[[nodiscard]] ExtremeOutcome refusedWith(const std::string& words, const std::function<void()>& work);

}  // namespace palpate
