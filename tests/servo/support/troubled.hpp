// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/troubled.hpp: a device and an algorithm that go through every trouble in turn, on the real clock.
//
// For tests that watch the servo thread while the safety gate has work to do.
#pragma once

#include <limits>

#include "servo/algorithms/algorithm.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

class TroubledDevice final : public Device {
 public:
  // Without trouble it is the simulated device and nothing else.
  TroubledDevice(const Path& path, bool troubled) : inner_(coarse(), path, 1000), on_(troubled) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "troubled"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return inner_.limits(); }
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override { return inner_.held(force_W); }
  void elapse(int ticks) noexcept override { inner_.elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    ++reads_;
    if (trouble() == Trouble::kRead) return false;
    if (on_ && reads_ % 150 == 75) standStill();
    return inner_.read(position_W);
  }
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override {
    return trouble() == Trouble::kReports ? 30'000'000 : 0;
  }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    return trouble() != Trouble::kWrite && inner_.write(force_W);
  }

 private:
  static SimulatedDeviceParameters coarse() {
    SimulatedDeviceParameters p;
    p.encoder_resolution_m = 1e-6;
    return p;
  }
  enum class Trouble { kNone, kRead, kReports, kWrite };
  [[nodiscard]] Trouble trouble() const noexcept {
    if (!on_ || reads_ < 10 || reads_ % 10 >= 3) return Trouble::kNone;
    return static_cast<Trouble>(reads_ / 10 % 4);
  }
  // Busy for long enough to be a stall, without a system call.
  static void standStill() noexcept {
    const std::int64_t until_ns = monotonicNow_ns() + 15'000'000;
    while (monotonicNow_ns() < until_ns) {
    }
  }

  SimulatedDevice inner_;
  bool on_;
  int reads_ = 0;
};

// Now and then it gives NaN, and a force that no device can give.
class TroubledAlgorithm final : public Algorithm {
 public:
  TroubledAlgorithm(Algorithm& inner, bool troubled) : inner_(inner), on_(troubled) {}
  void reset(const Vec3& hip_W) noexcept override { inner_.reset(hip_W); }
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    inner_.tick(in, out);
    if (!on_) return;
    ++ticks_;
    if (ticks_ % 30 == 7) out.force_W.x() = std::numeric_limits<double>::quiet_NaN();
    if (ticks_ % 30 == 20) out.force_W *= 1e6;
  }

 private:
  Algorithm& inner_;
  bool on_;
  int ticks_ = 0;
};

// Limits at which every trouble shows; adaptive windowing and the passivity controller are on.
inline LoopParameters troubledParameters() {
  LoopParameters p;
  p.velocity.name = "foaw";
  p.passivity.control = true;
  p.safety.force_limit_N = 0.5;
  p.safety.slew_limit_N_per_s = 50;
  p.safety.fade_s = 0.005;
  p.safety.stale_window_s = 0.005;
  return p;
}

// The engine's confirmation, by the number of the call: right for 50 calls, silent for 50, an hour ahead for 50.
inline void confirmWithTrouble(WindowExchange& windows, std::int64_t look, bool troubled) {
  const std::int64_t part = troubled ? look / 50 % 3 : 0;
  if (part == 1) return;
  windows.confirm(monotonicNow_ns() + (part == 2 ? 3'600'000'000'000 : 0));
}

}  // namespace palpate
