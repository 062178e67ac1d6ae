// SPDX-License-Identifier: Apache-2.0
// servo/devices/believed_counts.hpp: which counts of an arm's encoders are believed, and where the handle is by them.
//
// Encoders count in 16 bits, and go on at the other end. Counts whose place no hand can have reached in the time
// (hand_motion.hpp) leap: they are not used. Three leaps in a row say that the arm counts from elsewhere: it has been
// switched off meanwhile, or a joint has slipped on its capstan.
// Frame A, the arm's (arm_kinematics.hpp). Units: m, rad, s. Thread: one. No heap, no errors.
#pragma once

#include "base/vec.hpp"
#include "servo/devices/arm_kinematics.hpp"
#include "servo/devices/hand_motion.hpp"
#include "servo/devices/polhem_report.hpp"

namespace palpate {

class BelievedCounts {
 public:
  static constexpr int kMostLeaps = 3;
  // The longest way that is believed of a silence, however long: half a second is enough for the arm to be switched off
  // and on [m].
  static constexpr double kLongestLeap_m = 0.1;

  // `tick_s`: the shortest time that a report can be after another.
  BelievedCounts(const ArmKinematics& arm, double tick_s) noexcept;

  struct Interval {   // between two reports [s]
    double time_s;    // from the arrival of one to that of the other
    double waited_s;  // that the earlier one may have been older
    double silent_s;  // of the time: beyond what a report takes the arm said nothing
  };
  enum class Verdict {
    kMotion,     // the handle went there
    kLeap,       // it cannot have; nothing is changed
    kElsewhere,  // so it is for the third time in a row: the arm counts from there
  };
  // Counts of a report that came so long after the last believed one.
  [[nodiscard]] Verdict look(const PolhemCounts& raw, const Interval& since) noexcept;
  // The arm counts from there, whatever was before.
  void countFrom(const PolhemCounts& raw) noexcept;

  [[nodiscard]] const PolhemCounts& raw() const noexcept { return raw_; }  // as the newest believed report has them
  [[nodiscard]] const ArmCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const Vec3& angles() const noexcept { return angles_; }
  [[nodiscard]] const Vec3& position_A() const noexcept { return position_A_; }

 private:
  [[nodiscard]] ArmCounts countsOn(const PolhemCounts& raw) const noexcept;
  [[nodiscard]] double longestWay_m(const Interval& since) const noexcept;
  void take(const PolhemCounts& raw, const ArmCounts& counts) noexcept;

  ArmKinematics arm_;
  double tick_s_;
  MotionLaw motion_;
  PolhemCounts raw_{};
  ArmCounts counts_{};
  Vec3 angles_ = Vec3::Zero(), position_A_ = Vec3::Zero();
  int leaps_ = 0;  // in a row
  Vec3 leapt_to_A_ = Vec3::Zero();
};

}  // namespace palpate
