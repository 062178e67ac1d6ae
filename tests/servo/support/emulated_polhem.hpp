// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/emulated_polhem.hpp: the other end of a Polhem's cable: firmware, motors, arm, encoders and hand.
//
// Written from the firmware's behaviour (polhem_report.hpp names the source), not from the host's code: it sends a
// report when it is switched on, then one for each that it gets; a command to count from elsewhere exerts no force; the
// amplifiers are cut off when no report came for 0.5 s. Each report moves time on by one tick: arm and hand are those
// of HandDynamics, led along a path. Frame D, the device's [m, N].
#pragma once

#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "servo/devices/arm_kinematics.hpp"
#include "servo/devices/hand_dynamics.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/polhem_device.hpp"
#include "servo/devices/polhem_report.hpp"

namespace palpate {

// How motors and encoders are plugged in: `motor[k]` is what the plug of motor k drives, with the leads as `sign` says,
// 0 for one that is dead; `encoder[k]` is what the plug of encoder k tells, -1 for one that is dead.
struct ArmWiring {
  std::array<int, 3> motor = {0, 1, 2};
  std::array<int, 3> sign = {1, 1, 1};
  std::array<int, 3> encoder = {0, 1, 2};
};

class EmulatedPolhem {
 public:
  static constexpr double kWatchdog_s = 0.5;

  // Switched on in its home position's counts if `calibrated`; else it counts from 0 where it is.
  EmulatedPolhem(const PolhemParameters& parameters, const HandParameters& hand, const Path& path, double tick_s,
                 bool calibrated = true)
      : parameters_(parameters),
        arm_(parameters.joints, parameters.origin_m),
        dynamics_(hand, tick_s),
        path_(path),
        tick_s_(tick_s) {
    state_.position_W = path.position(0);
    if (!calibrated) restart();
  }

  // As after the power was away: the encoders count from 0 where they are.
  void restart() {
    const ArmCounts now = trueCounts();
    for (std::size_t k = 0; k < 3; ++k) offset_[k] = -now[k];
    currents_A_.setZero();
    asks_ = nears_home_ = false;
  }
  // However it is wired, and as it was told in its home position by a host that takes it for an arm with other counts
  // there.
  void wire(const ArmWiring& wiring, const std::array<int, 3>& home_counts) {
    wiring_ = wiring;
    for (std::size_t k = 0; k < 3; ++k)
      offset_[k] = home_counts[k] -
                   (wiring.encoder[k] < 0 ? 0 : parameters_.home_counts[static_cast<std::size_t>(wiring.encoder[k])]);
  }
  // The hand stays where its path begins until the motors have pushed and then been still for so many ticks.
  void waitForPushes(int still_ticks) { waits_ticks_ = still_ticks; }
  void pressCalibration() { asks_ = true; }
  void releaseCalibration() { asks_ = false; }  // which no firmware does: a damaged report may look so
  // The same where the handle is near its home position: it counts as if it had been exactly there before.
  void recalibrate() { asks_ = nears_home_ = true; }
  void press(bool pressed) { pressed_ = pressed; }
  // A joint slips on its capstan: from now on its encoder counts so much more.
  void slip(std::size_t joint, std::int64_t counts) { offset_[joint] += counts; }

  [[nodiscard]] Report state() const {
    PolhemState state;
    const ArmCounts now = trueCounts();
    for (std::size_t k = 0; k < 3; ++k) state.counts[k] = static_cast<std::int16_t>(now[k] + offset_[k]);
    state.asks_for_calibration = asks_;
    state.pressed = pressed_;
    return polhemStateReport(state, static_cast<std::size_t>(parameters_.report_bytes));
  }

  // A report as it arrives, with its number in front; the answer. Moves time on by one tick.
  Report answer(const Report& report) {
    silent_s_ = 0;
    const auto command =
        parsePolhemCommand(report.content().subspan(1), static_cast<std::size_t>(parameters_.report_bytes));
    if (command && command->count_from && nears_home_ && isHome(*command->count_from)) {
      offset_ = {};
      asks_ = nears_home_ = false;
      currents_A_.setZero();
    } else if (command && command->count_from) {
      const ArmCounts now = trueCounts();
      for (std::size_t k = 0; k < 3; ++k) offset_[k] = (*command->count_from)[k] - now[k];
      asks_ = false;
      currents_A_.setZero();
    } else if (command) {
      for (std::size_t k = 0; k < 3; ++k)
        currents_A_[wiring_.motor[k]] = 1e-3 * wiring_.sign[k] * command->currents_mA[k];
    }
    passTick();
    return state();
  }

  // Time goes on without a report.
  void passSilence(double time_s) {
    for (double t = 0; t < time_s; t += tick_s_) {
      silent_s_ += tick_s_;
      if (silent_s_ > kWatchdog_s) currents_A_.setZero();
      passTick();
    }
  }

  [[nodiscard]] Vec3 force_D() const { return fromArm(arm_.force(currents_A_, angles())); }
  [[nodiscard]] const HandDynamics::State& hand() const { return state_; }
  [[nodiscard]] const std::vector<Vec3>& forces_D() const { return forces_D_; }  // that acted, tick by tick
  [[nodiscard]] const Vec3& currents_A() const { return currents_A_; }

 private:
  static Vec3 fromArm(const Vec3& v) { return {v.y(), v.z(), v.x()}; }
  static Vec3 toArm(const Vec3& v) { return {v.z(), v.x(), v.y()}; }
  // A hand that goes farther than the arm can leaves it where it was.
  [[nodiscard]] Vec3 angles() const {
    angles_ = arm_.anglesAt(toArm(state_.position_W)).value_or(angles_);
    return angles_;
  }
  // As the encoders' plugs tell them.
  [[nodiscard]] ArmCounts trueCounts() const {
    const ArmCounts turned = arm_.countsAt(angles());
    ArmCounts told{};
    for (std::size_t k = 0; k < 3; ++k)
      told[k] = wiring_.encoder[k] < 0 ? 0 : turned[static_cast<std::size_t>(wiring_.encoder[k])];
    return told;
  }
  [[nodiscard]] bool isHome(const PolhemCounts& counts) const {
    const std::array<int, 3>& home = parameters_.home_counts;
    return counts[0] == home[0] && counts[1] == home[1] && counts[2] == home[2];
  }
  void passTick() {
    const Vec3 force = force_D();
    forces_D_.push_back(force);
    const Vec3 start = path_.position(time_s_);
    if (waits_ticks_ > 0) {
      was_pushed_ = was_pushed_ || !force.isZero(0);
      still_ticks_ = force.isZero(0) ? still_ticks_ + 1 : 0;
      if (was_pushed_ && still_ticks_ >= waits_ticks_) waits_ticks_ = 0;
    } else {
      time_s_ = static_cast<double>(++ticks_) * tick_s_;
    }
    state_ = dynamics_.step(state_, start, path_.position(time_s_), force);
  }

  PolhemParameters parameters_;
  ArmKinematics arm_;
  HandDynamics dynamics_;
  const Path& path_;
  double tick_s_, time_s_ = 0, silent_s_ = 0;
  std::int64_t ticks_ = 0;
  HandDynamics::State state_;
  mutable Vec3 angles_ = Vec3::Zero();
  ArmWiring wiring_;
  std::array<std::int64_t, 3> offset_{};
  Vec3 currents_A_ = Vec3::Zero();
  int waits_ticks_ = 0, still_ticks_ = 0;  // 0: it waits for nothing
  bool was_pushed_ = false;
  bool asks_ = false, pressed_ = false, nears_home_ = false;
  std::vector<Vec3> forces_D_;
};

// A cable in memory: answers wait in it until they are read. The device may be unplugged.
class EmulatedCable {
 public:
  explicit EmulatedCable(EmulatedPolhem& device) : device_(device) {}

  [[nodiscard]] PortOpener opener() {
    return [this]() -> std::unique_ptr<ReportPort> {
      if (unplugged) throw std::runtime_error("not there");
      waiting_.clear();
      if (says_itself) waiting_ = {device_.state()};
      return std::make_unique<Port>(*this);
    };
  }
  bool unplugged = false;
  bool refuses = false;               // the next write, and then the cable is pulled
  bool says_itself = true;            // the device sends a report when it is opened
  std::chrono::microseconds pace{0};  // what an answer takes, by the real clock
  // What the cable makes of an answer; empty: nothing. No report: the answer is lost.
  std::function<std::optional<Report>(Report)> spoil = {};

 private:
  class Port final : public ReportPort {
   public:
    explicit Port(EmulatedCable& cable) : cable_(cable) {}
    PortRead read(Report& report, int) noexcept override {
      if (cable_.unplugged) return PortRead::kGone;
      if (cable_.waiting_.empty()) return PortRead::kNothing;
      report = cable_.waiting_.front();
      cable_.waiting_.pop_front();
      return PortRead::kReport;
    }
    bool write(const Report& report) noexcept override {
      if (std::exchange(cable_.refuses, false)) {
        cable_.unplugged = true;
        return false;
      }
      if (cable_.unplugged) return false;
      if (cable_.pace.count() > 0) std::this_thread::sleep_for(cable_.pace);
      const Report answer = cable_.device_.answer(report);
      const std::optional<Report> sent = cable_.spoil ? cable_.spoil(answer) : answer;
      if (sent) cable_.waiting_.push_back(*sent);
      return true;
    }

   private:
    EmulatedCable& cable_;
  };

  EmulatedPolhem& device_;
  std::deque<Report> waiting_;
};

}  // namespace palpate
