// SPDX-License-Identifier: Apache-2.0
// servo/devices/home_calibration.hpp: whether an arm counts from its home position, and who may tell it to.
//
// Encoders count from where the arm was when it was switched on. So a hand puts the handle into its home position once,
// and asks: by the arm's button, or by a program. The arm is then told to count from home. This class decides; whoever
// owns it tells the arm (Order) and reports what the arm answers.
//
// - The button. The arm holds what its button asked until it is told to count from somewhere. A press counts if the
//   button was seen free a moment before and pressed for a while (debounced_button.hpp). A press that nobody saw begin
//   takes the calibration away: where the handle was then nobody knows.
// - Refusals. A calibration is refused while the arm pushes, while the handle moves, and where a calibrated arm says
//   that it is not at home: it would turn the force of the next contact anywhere. Nothing changes then.
// - After a refusal the arm still holds what its button asked, and no command makes it forget that. But one makes it
//   count from given numbers. So once the handle rests without force the arm is told to count on from what it counts.
//   Who moves the handle within the two reports that this takes shifts the count by as much.
// - Answers. What counts as one came after the arm was told, over the same connection.
// - Poses that the joints do not allow, three in a row, say that a calibrated arm is another one, or was calibrated
//   elsewhere: it is not calibrated any more.
//
//   from                         to            when
//   any                          kForgetting   the button is pressed, and nobody had looked just before
//   any                          kCalibrating  the button is pressed, or a program asks, and it is not refused
//   any                          kRefused      the button is pressed, and it is refused
//   kRefused                     kCountingOn   the handle rests without force
//   kRefused                     kCounts       the button is free by itself
//   kForgetting, kCalibrating    kCounts       the arm counts from home; after kCalibrating it is calibrated
//   kCountingOn                  kCounts       the arm has heard it
//   any                          kCounts       another connection
//
// Times are of the reports, `now_s` is the present by the same clock [s]. Units: m, rad, N. Threads: one, the servo's;
// isCalibrated() and the counts by any. No heap, no lock, no errors.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>

#include "base/vec.hpp"
#include "servo/devices/calibration_refusal.hpp"
#include "servo/devices/debounced_button.hpp"

namespace palpate {

class HomeCalibration {
 public:
  enum class State {
    kCounts,       // nothing is under way
    kRefused,      // its button asked, was refused, and is still held by the arm
    kForgetting,   // told to count from home, uncalibrated
    kCalibrating,  // told to count from home
    kCountingOn,   // told to count from what it counts
  };
  enum class Order { kNone, kCountFromHome, kCountOn };  // what the arm is to be told now

  // The handle rests while it stays within 1 mm for 0.1 s: a hand's tremor does, one that goes at 10 mm/s does not.
  static constexpr double kRest_m = 1e-3, kRest_s = 0.1;
  static constexpr double kPush_N = 0.05;       // a force that counts as pushing, then and for kRest_s after
  static constexpr double kAtHome_m = 0.03;     // a hand puts the handle back to its home position better than that
  static constexpr double kTold_s = 2;          // for so long a refusal is told
  static constexpr double kJustBefore_s = 0.1;  // so long before it was pressed the button was seen free
  static constexpr int kAskAgain = 100;         // reports after which an order that was not heard is given again
  static constexpr int kImpossible = 3;         // poses in a row

  // `reach_m`: how far a radian of each joint moves the handle at most [m/rad]; `home`: angles in the home position.
  HomeCalibration(const Vec3& reach_m, const Vec3& home, bool is_calibrated) noexcept
      : reach_m_(reach_m), home_(home), calibrated_(is_calibrated) {}

  // What the arm says from now on is of another connection. `was_away`: it may count from elsewhere.
  void beginAnew(bool was_away) noexcept;
  // The arm counts from elsewhere for another reason.
  void forget() noexcept { calibrated_.store(false, std::memory_order_relaxed); }
  // A force acts on the hand.
  void push(double force_N, double now_s) noexcept {
    if (force_N > kPush_N) pushed_s_ = now_s;
  }

  enum class Answer {
    kNone,      // the report answers nothing, or nothing that changes its counts
    kTooEarly,  // it looks like an answer, but may have been sent before: it is not to be used
    kFromHome,  // the arm counts from home now
  };
  // Of each report, before look(). `requests`: how many orders the arm had heard when it sent it; `asks`: its button's
  // line; `is_home`: its counts are those of the home position.
  [[nodiscard]] Answer answer(std::uint64_t requests, bool asks, bool is_home) noexcept;

  struct Seen {
    double time_s = 0;
    Vec3 angles = Vec3::Zero();
    bool asks = false;          // the button's line
    bool just_before = false;   // the report before is no older than kJustBefore_s
    bool is_elsewhere = false;  // its counts began anew: the handle has not been seen at rest
    bool is_possible = true;    // the joints allow this pose
  };
  // Of each report that counts. The order must be given to the arm.
  [[nodiscard]] Order look(const Seen& seen, double now_s) noexcept;

  // A program asks. kNone: the arm must be told to count from home.
  [[nodiscard]] CalibrationRefusal ask(double now_s) noexcept;
  // What ask() would say.
  [[nodiscard]] CalibrationRefusal whyNot(double now_s) const noexcept;
  // The button's last refusal, for kTold_s.
  [[nodiscard]] CalibrationRefusal refusal(double time_s) const noexcept;

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] bool isCalibrated() const noexcept { return calibrated_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t calibrations() const noexcept { return calibrations_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t impossiblePoses() const noexcept { return impossible_.load(std::memory_order_relaxed); }
  // As kCalibrationRefusals orders them.
  [[nodiscard]] std::uint64_t refusals(std::size_t which) const noexcept {
    return refusals_[which].load(std::memory_order_relaxed);
  }

 private:
  Order order(State state) noexcept;
  Order press(double time_s, double now_s) noexcept;
  Order heedButton(const Seen& seen, double now_s) noexcept;
  void noteRest(const Seen& seen) noexcept;
  void notePose(bool is_possible) noexcept;
  [[nodiscard]] bool rests() const noexcept { return seen_s_ - rests_since_s_ >= kRest_s; }
  [[nodiscard]] bool isFree(double now_s) const noexcept { return !(now_s - pushed_s_ < kRest_s); }
  [[nodiscard]] double way_m(const Vec3& from, const Vec3& to) const noexcept;

  Vec3 reach_m_, home_;
  State state_ = State::kCounts;
  std::atomic<bool> calibrated_;
  DebouncedButton button_;
  bool was_seen_free_ = false;             // the button, just before it was pressed
  std::uint64_t heard_ = 0, request_ = 0;  // orders that the arm has heard; the one that is to be answered
  int unheard_reports_ = 0;                // since the order, in which the button still asks
  int impossible_poses_ = 0;               // in a row
  CalibrationRefusal refusal_ = CalibrationRefusal::kNone;
  double refused_s_ = -std::numeric_limits<double>::infinity();
  double seen_s_ = 0;           // time of the newest report that counts
  Vec3 angles_ = Vec3::Zero();  // that it told
  Vec3 rest_ = Vec3::Zero();    // angles near which the handle stays
  double rests_since_s_ = 0;
  double pushed_s_ = -std::numeric_limits<double>::infinity();
  std::atomic<std::uint64_t> calibrations_{0}, impossible_{0};
  std::array<std::atomic<std::uint64_t>, kCalibrationRefusals.size()> refusals_{};
};

}  // namespace palpate
