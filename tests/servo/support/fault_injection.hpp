// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/fault_injection.hpp: a loop whose clock, engine, device and algorithm go wrong as a script says.
//
// Everything runs in the loop's own code (ServoLoop::runOn) on a scripted clock. The script counts ticks that are run,
// not grid points. A fault begins at such a tick and lasts for some of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "servo/algorithms/algorithm.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {

enum class Injected {
  kNanSample,       // a window with NaN samples is published
  kInfiniteSample,  // a window with infinite samples is published
  kSilentEngine,    // the engine neither publishes nor confirms
  kEngineClock,     // the engine's time is off by `size` seconds
  kServoClock,      // the servo's clock steps by `size` seconds, once
  kStallAsleep,     // the wake-up comes `size` seconds late, once
  kStallInTick,     // the device takes `size` seconds to answer, once
  kReadError,       // the device does not answer
  kNanPosition,     // the device answers with NaN
  kWildPosition,    // the device answers with a position that is `size` metres off
  kWriteError,      // the device takes no force
  kFlakyWrites,     // the device takes a force only now and then
  kDroppedReports,  // the device has no new position
  kNanForce,        // the algorithm gives NaN
  kInfiniteForce,   // the algorithm gives infinity
  kForceOff,        // the device exerts no force, for a reason of its own
  kHugeForce,       // the algorithm gives `size` newtons in some direction
  kCount,
};

struct InjectedFault {
  Injected kind = Injected::kCount;
  int first_tick = 0;
  int ticks = 1;
  double size = 0;
};

class FaultScript {
 public:
  std::vector<InjectedFault> faults;
  int tick = -1;  // the tick that runs

  // The fault of this kind that is on in this tick, or null.
  [[nodiscard]] const InjectedFault* active(Injected kind) const noexcept {
    const auto on = [&](const InjectedFault& f) {
      return f.kind == kind && tick >= f.first_tick && tick < f.first_tick + f.ticks;
    };
    const auto found = std::find_if(faults.begin(), faults.end(), on);
    return found == faults.end() ? nullptr : &*found;
  }
  // The fault's size in its first tick, else 0.
  [[nodiscard]] double once(Injected kind) const noexcept {
    const InjectedFault* fault = active(kind);
    return fault != nullptr && fault->first_tick == tick ? fault->size : 0;
  }
};

// Time passes while the loop sleeps, by a microsecond at each look at the clock, and as the script says.
class ScriptedClock final : public ServoClock {
 public:
  explicit ScriptedClock(FaultScript& script) : script_(script) {}
  [[nodiscard]] std::int64_t now_ns() noexcept override { return time_ns += 1000; }
  void sleepUntil(std::int64_t due_ns) noexcept override {
    time_ns = std::max(time_ns, due_ns);
    ++script_.tick;
    pass(script_.once(Injected::kStallAsleep) + script_.once(Injected::kServoClock));
    if (before_tick) before_tick();
  }
  void pass(double seconds) noexcept { time_ns += std::llround(seconds * 1e9); }

  std::int64_t time_ns = 3'600'000'000'000;  // an hour after the machine started
  std::function<void()> before_tick;

 private:
  FaultScript& script_;
};

// A ball's pole or any other surface, in one small window that is published again every 16 ticks.
class ScriptedEngine {
 public:
  static constexpr int kSide = 12;  // samples along each axis

  ScriptedEngine(FaultScript& script, const AnalyticVolume& volume, const Vec3& around_W) : script_(script) {
    const Vec3i count = Vec3i::Constant(kSide);
    volume.hold(held_, volume.firstAround(around_W, count), count);
  }

  void beforeTick(WindowExchange& windows, std::int64_t now_ns) {
    if (script_.active(Injected::kSilentEngine) != nullptr) return;
    if (const InjectedFault* fault = script_.active(Injected::kEngineClock)) now_ns += std::llround(fault->size * 1e9);
    const bool poisoned =
        script_.active(Injected::kNanSample) != nullptr || script_.active(Injected::kInfiniteSample) != nullptr;
    // A window that was spoiled is followed by a good one.
    if (published_ && script_.tick % 16 != 0 && poisoned == spoiled_) return windows.confirm(now_ns);
    SampleWindow& window = windows.back();
    window = held_.window;
    window.stamp_ns = now_ns;
    window.edit_version = static_cast<std::uint64_t>(script_.tick / 48);
    std::memcpy(static_cast<void*>(windows.backSamples()), held_.samples.data(), held_.samples.size() * sizeof(Sample));
    if (poisoned) poison(windows.backSamples());
    windows.publish();
    published_ = true;
    spoiled_ = poisoned;
  }

 private:
  // Every third sample, so that most cells have some.
  void poison(Sample* samples) const {
    const float bad = script_.active(Injected::kNanSample) != nullptr ? std::numeric_limits<float>::quiet_NaN()
                                                                      : std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < held_.samples.size(); i += 3) samples[i] = {bad, -bad, bad, i % 2 == 0 ? bad : -bad};
  }

  FaultScript& script_;
  HeldWindow held_;
  bool published_ = false;
  bool spoiled_ = false;
};

class ScriptedDevice final : public Device {
 public:
  using Motion = std::function<Vec3(int tick)>;
  ScriptedDevice(FaultScript& script, ScriptedClock& clock, Motion motion, double rate_hz)
      : script_(script), clock_(clock), motion_(std::move(motion)), period_ns_(std::llround(1e9 / rate_hz)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "scripted"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    return {.force_limit_N = force_limit_N,
            .position_resolution_m = 1e-6,
            .slew_limit_N_per_s = slew_limit_N_per_s,
            .is_held = is_held};
  }
  [[nodiscard]] ForceOff forceOff() const noexcept override {
    return script_.active(Injected::kForceOff) != nullptr ? why_off : ForceOff::kNone;
  }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    clock_.pass(script_.once(Injected::kStallInTick));
    // The loop's first look at the device is its constructor's, before any tick.
    if (script_.tick >= 0) answered.push_back(answers());
    if (script_.active(Injected::kReadError) != nullptr) return false;
    if (script_.active(Injected::kDroppedReports) == nullptr) {
      reported_W_ = motion_(script_.tick);
      reported_tick_ = script_.tick;
    }
    position_W = reported_W_;
    if (const InjectedFault* fault = script_.active(Injected::kWildPosition)) position_W.y() += fault->size;
    if (script_.active(Injected::kNanPosition) != nullptr) position_W.x() = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override {
    return (script_.tick - reported_tick_) * period_ns_;
  }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    written_W.push_back(force_W);
    taken.push_back(takes());
    if (taken.back()) held_now_W_ = held(force_W);
    held_W.push_back(held_now_W_);
    return taken.back();
  }
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override {
    if (forceOff() != ForceOff::kNone) return Vec3::Zero();
    const double size_N = force_W.stableNorm();
    return size_N > cut_N ? Vec3(force_W / size_N * cut_N) : force_W;
  }

  // Reserves memory for so many writes.
  void reserve(std::size_t writes) {
    written_W.reserve(writes);
    taken.reserve(writes);
    held_W.reserve(writes);
    answered.reserve(writes);
  }

  double force_limit_N = 20;      // as limits() states it
  double slew_limit_N_per_s = 0;  // as limits() states it
  bool is_held = false;           // as limits() states it
  ForceOff why_off = ForceOff::kUncalibrated;
  std::vector<Vec3> written_W;  // every force that left the loop, whether the device took it or not [N]
  std::vector<bool> taken;
  std::vector<Vec3> held_W;                                // what the device holds after each of them [N]
  double cut_N = std::numeric_limits<double>::infinity();  // it holds at most this, which only held() tells
  std::vector<bool> answered;                              // for each tick: the device gave a position that can be used

 private:
  [[nodiscard]] bool takes() const noexcept {
    const bool flaky = script_.active(Injected::kFlakyWrites) != nullptr && script_.tick * 7919 % 13 < 7;
    return script_.active(Injected::kWriteError) == nullptr && !flaky;
  }
  [[nodiscard]] bool answers() const noexcept {
    return script_.active(Injected::kReadError) == nullptr && script_.active(Injected::kNanPosition) == nullptr;
  }

  FaultScript& script_;
  ScriptedClock& clock_;
  Motion motion_;
  std::int64_t period_ns_;
  Vec3 held_now_W_ = Vec3::Zero();
  Vec3 reported_W_ = Vec3::Zero();
  int reported_tick_ = 0;
};

// Passes on another algorithm's output, with its force spoiled by the script.
class ScriptedAlgorithm final : public Algorithm {
 public:
  ScriptedAlgorithm(FaultScript& script, Algorithm& inner) : script_(script), inner_(inner) {}
  void reset(const Vec3& hip_W) noexcept override { inner_.reset(hip_W); }
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    inner_.tick(in, out);
    if (const InjectedFault* fault = script_.active(Injected::kHugeForce)) {
      const double side = script_.tick % 2 == 0 ? 1 : -1;
      out.force_W = Vec3(fault->size, side * fault->size, 0);
    }
    if (script_.active(Injected::kNanForce) != nullptr) out.force_W.z() = std::numeric_limits<double>::quiet_NaN();
    if (script_.active(Injected::kInfiniteForce) != nullptr) out.force_W.y() = -std::numeric_limits<double>::infinity();
    wanted_W = out.force_W;
  }

  Vec3 wanted_W = Vec3::Zero();  // of the last tick [N]

 private:
  FaultScript& script_;
  Algorithm& inner_;
};

// An algorithm whose force does not depend on where the tool is.
class SteadyPush final : public Algorithm {
 public:
  explicit SteadyPush(const Vec3& force_W) : force_W_(force_W) {}
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W;
    if (in.window->usable()) {
      out.force_W = force_W_;
    } else {
      out.faults = bit(ServoFault::kNoWindow);
    }
  }

 private:
  Vec3 force_W_;
};

}  // namespace palpate
