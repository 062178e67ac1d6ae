// SPDX-License-Identifier: Apache-2.0
// servo/devices/motor_check.hpp: does each motor of an arm turn its own joint, the right way, and by as much as it
// should?
//
// - A push. Each motor in turn pushes the handle for a moment, and back: half a sine of 0.1 s one way, half a sine the
//   other way, which stops what it moved; then the same with the other sign.
// - The answer of a joint is the mean of its angle over the first halves, the two signs' difference halved: a hand that
//   drifts cancels out. Mass, damper and spring all answer with the sign of the push, so a hand may hold the handle; it
//   only makes the answer smaller.
// - Which joint answers. The ways of the joints are compared at the handle, each as far as its motor's force would move
//   it. There the joint that is pushed moves most, whatever the pose, since the others are carried along by the cosine
//   between their ways.
// - How much is right: kWeakest to kStrongest times what an arm answers that nobody holds, m x'' = F - b x'. A hand,
//   friction and a guessed mass that is too small make it less, a guessed mass that is too large makes it more. Motors
//   of another arm may be 12 times as strong.
// - How hard. Pushes begin with kFirst_N and grow until something answers, so that motors that are too strong push no
//   harder than one that is right. An arm may give less than it is asked for (JointedArm::push()). What it gave is what
//   its answer is held against, and at its most the push is repeated: the mean of n answers has 1/sqrt(n) of the noise.
// Thread: that of the device, once a tick, after its read(). No heap, no errors.
#pragma once

#include <array>

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
  // An answer of less may be a count's rounding: of one push, and of the mean of many.
  static constexpr double kClear_counts = 4, kLeastClear_counts = 1;
  static constexpr int kMostTries = 16;  // of the hardest push that an arm gives, where that is less than kLast_N
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
  // The handle of an arm that nobody holds, under the forces that this one gives.
  struct Model {
    double way_m = 0, speed_m_per_s = 0, force_N = 0;
    void pass(double time_s, double mass_kg, double damping_Ns_per_m) noexcept;
  };
  // Sums over the first halves of pushes.
  struct Sums {
    Vec3 way = Vec3::Zero();  // of the joints [rad]
    double expected_m = 0;    // of the model
    int samples = 0;
  };
  void rest(double time_s) noexcept;
  void push(double time_s) noexcept;
  void pushBy(double force_N) noexcept;
  void endPush() noexcept;
  void judge() noexcept;
  void beginForce(double force_N) noexcept;

  JointedArm& arm_;
  std::array<MotorFinding, 3> findings_{};
  int motor_ = 0;
  double force_N_ = kFirst_N, sign_ = 1;
  bool is_cut_ = false;  // the arm gives less than that
  Phase phase_ = Phase::kBegin;
  double begin_s_ = 0, last_s_ = 0;  // of the phase; the last tick
  Vec3 start_ = Vec3::Zero();        // angles when it began, or near which the handle rests
  double noise_m_ = 0;               // within which it rests, or rested
  double most_noise_m_ = 0;          // of the pushes with this force
  double rests_s_ = 0;               // since when
  Model model_;
  Sums sums_;
  Vec3 answer_ = Vec3::Zero();    // to the pushes with this force, of both signs, summed
  double expected_m_ = 0;         // the same of the model
  int tries_ = 0;                 // pushes of both signs with this force
  Vec3 levers_m_ = Vec3::Zero();  // where it is tried
};

}  // namespace palpate
