// SPDX-License-Identifier: Apache-2.0
// servo/safety/safety_gate.hpp: the one gate through which a force leaves for the device.
//
// A force passes if it is finite, within the force limit and the slew limit, and built on a fresh window and a fresh
// position.
//
// Fades. A fault that takes the force away (kFadingFaults) makes the last healthy force fall to zero in a straight line
// within fade_s. Every tick of the fade is smaller than the one before, so the last force is never repeated. When the
// fault is gone, the wanted force comes back: it is multiplied by an authority that grows to 1 within fade_s. A fade
// and a return each start from where the other stopped. After a stall the force starts from zero. The device held an
// old force meanwhile, and what the algorithm wants now may be far larger.
//
// Starts. The authority of a device that a person holds begins at zero, and grows to the whole over start_s of healthy
// ticks: nobody knows where the hand is, and how firmly it holds. beginAnew() begins that again, where the tool or the
// device begins anew elsewhere. First it lets what is held fade, as a fault does.
//
// Ends. A run's end lets the force fade as a fault does: release().
//
// Held and offered. The force that counts is the one that the device holds: the last one that it took. pass() offers a
// force, taken() says that the device took it. A refused offer leaves no trace: the device holds the old force, and the
// next offer starts from there. So every force that the device takes is finite and within the limit, and differs from
// the one taken before by at most the slew. This holds however many offers were refused, or ticks left out, in between.
// While writes are refused nothing here can reduce what the device holds. That needs a watchdog in the device.
// A fade must keep within the slew too, so it lasts at least force_limit / slew_limit. The invariant behind this:
// except after a stall or refused writes, |force| <= force_limit * authority * (share of the start that has passed,
// or had passed before beginAnew(), until that fade is over). So a fade falls by at most force_limit / fade_ticks per
// tick. After a stall or refused writes it falls at the slew.
//
// Why the slew limit is high. It is meant for jumps: of the algorithm, of a window, of an edit. A force that lags
// behind its spring is too large on the way out and too small on the way in. So it gives energy (passivity.hpp counts
// it, on the force held). A limit that acts on every hard contact shakes it, at worst to a limit cycle of centimetres.
// The default is what a wall of 5000 N/m needs under a fast tap of 0.8 m/s: K v = 4000 N/s. 5000 N/m is the stiffest
// that vendors state for most of their devices (omega, delta, Polhem v2). A jump of 8 N takes 2 ms at this limit, at
// any rate.
// A trial took 8400 random contacts of up to 5000 N/m, met at up to 1 m/s, that settle without a limit. With a limit of
// 3000 N/s all of them still settled, with 2500 N/s 14 did not. tests/servo/loop/contact_stability_test.cpp tries such
// contacts at the default.
//
// Frame W: world [N]. Thread: the servo's. Cost: some 10 ns. Heap, locks, throws in pass(): none.
#pragma once

#include <cstdint>

#include "base/vec.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

struct SafetyParameters {
  double force_limit_N = 8;          // the device's maximum, or less [N]
  double slew_limit_N_per_s = 4000;  // [N/s]
  double fade_s = 0.1;               // from full force to none, and back [s]
  double stale_window_s = 0.25;      // a window last confirmed longer ago than this is stale [s]
  double stall_s = 0.01;             // a tick that is late by more than this ends a stall [s]
  double report_timeout_s = 0.02;    // an older position is a fault; 20 ms: a 125 Hz device may lose one report [s]
  double start_s = 0;                // from no force to all of it when a run begins; 0: all at once [s]

  static constexpr double kHeldStart_s = 1;  // start_s of a device that a person holds, at the least [s]
};

struct GateInput {
  Vec3 wanted_W = Vec3::Zero();    // the algorithm's force [N]
  std::int64_t window_age_ns = 0;  // since the engine last confirmed the window [ns]
  std::uint32_t faults = 0;        // raised before the gate in this tick
  std::int64_t gap_ns = 0;         // since the last tick; 0 in the first tick [ns]
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

  // The force to offer to the device. One call per tick.
  [[nodiscard]] GateOutput pass(const GateInput& in) noexcept;

  // Another force limit from the next pass() on, above 0 and finite [N]. A larger force that is held comes down at the
  // slew.
  void setForceLimit(double force_limit_N) noexcept;
  [[nodiscard]] double forceLimit() const noexcept { return parameters_.force_limit_N; }  // [N]

  // From the next pass() on. The tool or the device begins anew at another place: what is held fades, and what comes
  // back does so as at the start.
  void beginAnew() noexcept;

  // For the end of a run: the next force of a fade, whose direction stays. Offer it once per tick until the device
  // takes zero. It lasts fade_s, or as long as the slew limit asks for the force that is held. After a gap that is a
  // stall the rest goes at the slew.
  [[nodiscard]] Vec3 release(std::int64_t gap_ns = 0) noexcept;
  // Calls of release() until the force is zero, if the device takes each offer and no stall comes.
  [[nodiscard]] std::int64_t releaseTicks() const noexcept;

  // The device took the last offer and now holds `held_W`: the offer, or less. If `held_W` is not finite or above the
  // limit, the offer counts instead. Do not call it if the offer was refused.
  void taken(const Vec3& held_W) noexcept;

  [[nodiscard]] const Vec3& heldForce() const noexcept { return held_W_; }
  // fade_s in whole ticks, at least 1 and at least force_limit / slew_limit.
  [[nodiscard]] std::int64_t fadeTicks() const noexcept { return fade_ticks_; }
  [[nodiscard]] double slewPerTick() const noexcept { return slew_per_tick_N_; }  // [N]
  [[nodiscard]] bool isStall(std::int64_t gap_ns) const noexcept { return gap_ns > stall_ns_; }

 private:
  [[nodiscard]] std::uint32_t faultsOf(const GateInput& in) const noexcept;
  [[nodiscard]] Vec3 withinLimit(const Vec3& force_W) const noexcept;
  void offerFaded() noexcept;
  [[nodiscard]] Vec3 limited(const Vec3& wanted_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool offerTowards(const Vec3& target_W) noexcept;  // false: the slew limit held it back

  SafetyParameters parameters_;
  double rate_hz_;
  double slew_per_tick_N_;
  std::int64_t fade_ticks_;
  std::int64_t stale_ns_;
  std::int64_t stall_ns_;  // a longer gap between ticks is a stall [ns]
  std::int64_t report_timeout_ns_;
  std::int64_t authority_ticks_;      // 0: no force, fade_ticks_: all of it
  std::int64_t fade_from_ticks_ = 0;  // authority when the fade began
  std::int64_t start_ticks_;          // start_s
  std::int64_t started_ticks_ = 0;    // healthy ones since the start; at most start_ticks_
  Vec3 fade_from_W_ = Vec3::Zero();   // held when the fade began [N]
  Vec3 held_W_ = Vec3::Zero();        // the last force that the device took [N]
  Vec3 offer_W_ = Vec3::Zero();       // the last force offered [N]
  bool fading_ = false;
  bool lets_go_ = false;   // fades without a fault, until the authority is zero
  bool releases_ = false;  // the fade is that of release()
};

}  // namespace palpate
