// SPDX-License-Identifier: Apache-2.0
// servo/safety/safety_gate.hpp: the one gate through which a force leaves for the device.
//
// A force passes if it is finite, within the maximum and the slew, and built on a fresh window and a fresh position. A
// fault that takes the force away (kFadingFaults) makes the last healthy force fall in a straight line to zero within
// fade_s; every tick of the fade is smaller than the one before, so the last force is never repeated. When the fault is
// gone, the wanted force comes back as it went: multiplied by an authority that grows to 1 within fade_s. Both start
// from where the other stopped. After a stall the force starts from nothing: the device held an old force for a while,
// and what the algorithm wants now may be far larger than what it wanted then.
//
// In every case the force changes by at most the slew per call, however many ticks were left out before it. So that a
// fade keeps within it too, a fade lasts at least force_limit / slew_limit. The invariant behind this: but for a stall,
// |force| <= force_limit * authority, so a fade never falls by more than force_limit / fade ticks in one.
// Frame W: world [N]. Thread: the servo's. Cost: some 10 ns. Heap, locks, throws in pass(): none.
#pragma once

#include <cstdint>

#include "base/vec.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

struct SafetyParameters {
  double force_limit_N = 8;           // the device's maximum, or less [N]
  double slew_limit_N_per_s = 20000;  // [N/s]
  double fade_s = 0.1;                // from full force to none, and back [s]
  double stale_window_s = 0.5;        // a window last confirmed longer ago than this is stale [s]
  double stall_s = 0.01;              // a tick that comes later than this after it was due ends a stall [s]
  double report_timeout_s = 0.02;     // a device position older than this is a fault; a 125 Hz device may lose one [s]
};

struct GateInput {
  Vec3 wanted_W = Vec3::Zero();    // the algorithm's force [N]
  std::int64_t window_age_ns = 0;  // since the engine last confirmed the window [ns]
  std::uint32_t faults = 0;        // raised before the gate in this tick
  std::int64_t gap_ns = 0;         // since the last tick; 0 in the first [ns]
  std::int64_t report_age_ns = 0;  // of the position that the force is for [ns]
};

struct GateOutput {
  Vec3 force_W = Vec3::Zero();  // always finite and within the limits [N]
  std::uint32_t faults = 0;     // the input's and the gate's own
};

class SafetyGate {
 public:
  // Throws Error(kBadInput) unless limits and rate are positive and finite and the times finite and not negative.
  SafetyGate(const SafetyParameters& parameters, double rate_hz);

  // One call per tick.
  [[nodiscard]] GateOutput pass(const GateInput& in) noexcept;

  // Towards zero by one slew, and no authority is left: the end of a run, once per tick until it is zero.
  [[nodiscard]] const Vec3& release() noexcept;

  [[nodiscard]] const Vec3& lastForce() const noexcept { return last_W_; }
  // fade_s in whole ticks, at least 1 and at least what the slew limit makes it.
  [[nodiscard]] std::int64_t fadeTicks() const noexcept { return fade_ticks_; }
  [[nodiscard]] double slewPerTick() const noexcept { return slew_per_tick_N_; }  // [N]

 private:
  [[nodiscard]] std::uint32_t faultsOf(const GateInput& in) const noexcept;
  [[nodiscard]] Vec3 faded() noexcept;
  [[nodiscard]] Vec3 limited(const Vec3& wanted_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool moveTowards(const Vec3& target_W) noexcept;  // false: the slew limit held it back

  double force_limit_N_;
  double slew_per_tick_N_;
  std::int64_t fade_ticks_;
  std::int64_t stale_ns_;
  std::int64_t stall_ns_;  // largest gap between ticks that is none [ns]
  std::int64_t report_timeout_ns_;
  std::int64_t authority_ticks_;  // 0: no force, fade_ticks_: all of it
  std::int64_t hold_ticks_ = 0;   // authority when the fade began
  Vec3 hold_W_ = Vec3::Zero();    // last force before the fade [N]
  Vec3 last_W_ = Vec3::Zero();    // sent in the last tick [N]
  bool fading_ = false;
};

}  // namespace palpate
