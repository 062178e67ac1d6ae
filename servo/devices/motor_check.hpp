// SPDX-License-Identifier: Apache-2.0
// servo/devices/motor_check.hpp: does each motor of an arm turn its own joint, the right way, and by as much as it
// should?
//
// Each motor in turn pushes the handle for a moment, and back: half a sine of 0.1 s one way, half a sine the other way,
// which stops what it moved; then the same with the other sign. The answer of a joint is the mean of its angle over the
// first halves, the two signs' difference halved: a hand that drifts cancels out. Mass, damper and spring all answer
// with the sign of the push, so a hand may hold the handle; it only makes the answer smaller.
//   The ways of the joints are compared at the handle, each as far as its motor's force would move it. There the joint
// that is pushed moves most, whatever the pose, since the others are carried along by the cosine between their ways.
// An arm that nobody holds answers as m x'' = F - b x'. kWeakest to kStrongest times that is right: a hand, friction
// and a guessed mass make it less, and a lighter arm more; another arm's motors are 12 times as strong.
//   Pushes begin with kFirst_N and grow until something answers, so that motors that are too strong push no harder than
// one that is right. Thread: that of the device, once a tick, after its read(). No heap, no errors.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "servo/devices/jointed_arm.hpp"

namespace palpate {

struct MotorFinding {
  enum class Verdict {
    kRight,
    kReversed,  // its joint turns against the push
    kOther,     // another joint turns: `joint`
    kDead,      // no encoder answers
    kWeak,      // its encoder hardly answers
    kStrong,    // it answers as a motor of another arm would
    kRestless,  // the handle was not held still in the middle of the workspace
  };
  Verdict verdict = Verdict::kRestless;
  int joint = 0;     // that answered most
  double share = 0;  // of what an arm answers that nobody holds; below 0: against the push
};

class MotorCheck {
 public:
  static constexpr double kFirst_N = 0.03, kLast_N = JointedArm::kMostTrial_N;
  static constexpr double kPush_s = 0.1;
  static constexpr double kWeakest = 0.1, kStrongest = 4;
  static constexpr double kClear_counts = 4;  // an answer of less may be a count's rounding
  // The handle rests while it stays within this for kRest_s; after kQuiet_s a hand that trembles more will do. An
  // answer is clear if it is kClear times as large.
  static constexpr double kQuiet_m = 1e-4, kRest_m = 1e-3, kClear = 2;
  static constexpr double kRest_s = 0.15, kQuiet_s = 1.5, kPatience_s = 20;

  explicit MotorCheck(JointedArm& arm) : arm_(arm) {}

  // A tick: pushes, or waits until the handle rests. `time_s` of the device's reports [s]. False: all is found out.
  bool step(double time_s) noexcept;
  [[nodiscard]] const std::array<MotorFinding, 3>& findings() const noexcept { return findings_; }
  [[nodiscard]] bool isRight() const noexcept;
  // Which motor is tried now; 3: none any more.
  [[nodiscard]] int motor() const noexcept { return motor_; }

 private:
  enum class Phase { kBegin, kRest, kPush, kBrake };
  void rest(double time_s) noexcept;
  void push(double time_s) noexcept;
  void judge() noexcept;
  [[nodiscard]] double expected_m() const noexcept;

  JointedArm& arm_;
  std::array<MotorFinding, 3> findings_{};
  int motor_ = 0;
  double force_N_ = kFirst_N, sign_ = 1;
  Phase phase_ = Phase::kBegin;
  double begin_s_ = 0;            // of the phase
  Vec3 start_ = Vec3::Zero();     // angles when it began, or near which the handle rests
  double noise_m_ = 0;            // within which it rests, or rested
  double rests_s_ = 0;            // since when
  Vec3 sum_ = Vec3::Zero();       // of the way in this push
  int samples_ = 0;               // of which
  Vec3 answer_ = Vec3::Zero();    // to the first sign
  Vec3 levers_m_ = Vec3::Zero();  // where it is tried
};

// Where a hand went: along the axis of D in which it went furthest. An arm that is another one than its user says, or
// that was calibrated elsewhere, tells another way than the hand went, or another length.
struct HandWay {
  int axis = 0;
  bool positive = true;
  double length_m = 0;
};
[[nodiscard]] HandWay handWay(const Vec3& way_D) noexcept;
// "right", "left", "up", "down", "towards you", "away from you".
[[nodiscard]] const char* wordOf(const HandWay& way) noexcept;

// What a user is asked to do: right, up, towards you, by about kAsked_m each.
inline constexpr double kAsked_m = 0.06;
// Whether the hand went so along this axis; a user's measure may be off by half.
[[nodiscard]] bool isAsked(const HandWay& way, int axis) noexcept;

// Waits for a hand that rests, moves, and rests again.
class HandMove {
 public:
  static constexpr double kLeast_m = 0.02, kRest_m = 2e-3, kRest_s = 0.3;
  // A position of the handle at a time of the device's. Its way, once it rests again.
  std::optional<Vec3> look(const Vec3& position_D, double time_s) noexcept;

 private:
  std::optional<Vec3> from_D_;
  Vec3 rest_D_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  double rests_s_ = 0;
};

}  // namespace palpate
