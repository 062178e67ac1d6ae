// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/edit_ease.hpp: what an edit adds to a contact is not shown at once, but taken in evenly over
// kTime_s.
//
// The quantity that pushes (the depth behind a plane [m], a force [N]) is the whole. What is shown is the whole less an
// amount. An edit's addition goes into the amount, so what is shown goes on as it was; for a free tool it begins at
// nothing. The amount drains in equal steps, within kTime_s after the last addition; a later addition never slows the
// draining. The amount never exceeds the whole, so nothing pulls, and a tool that comes out by itself needs no more
// easing. What an edit takes away is not eased. So through edits the shown quantity rises by at most E / ticks() a
// tick, E being the largest amount that there was.
// Thread: the servo's; no heap, lock, system call or throw. Cost: a few additions, only in ticks with an amount.
#pragma once

#include <algorithm>
#include <cmath>

namespace palpate {

class EditEase {
 public:
  static constexpr double kTime_s = 0.5;

  explicit EditEase(double rate_hz) noexcept : ticks_(std::max(1.0, std::round(kTime_s * rate_hz))) {}

  // An edit has changed `shown` into `whole`, with the tool at the same place. An addition of up to `negligible` does
  // not count as the edit's.
  void take(double shown, double whole, double negligible = 0) noexcept {
    const double added = whole - shown - amount_;
    if (added > 0 && added <= negligible) return;
    amount_ = std::max(0.0, amount_ + added);
    step_ = amount_ > 0 ? std::max(step_, amount_ / ticks_) : 0;
  }
  // Once a tick, after take(). `whole`: that of this tick; 0 (no contact) ends the easing.
  void elapse(double whole) noexcept {
    amount_ = std::max(0.0, std::min(amount_ - step_, whole));
    if (amount_ == 0) step_ = 0;
  }
  void end() noexcept { amount_ = step_ = 0; }

  [[nodiscard]] bool active() const noexcept { return amount_ > 0; }
  [[nodiscard]] double amount() const noexcept { return amount_; }  // part of the whole that is not shown yet
  [[nodiscard]] double ticks() const noexcept { return ticks_; }    // ticks in which an amount drains

 private:
  double ticks_;
  double amount_ = 0;
  double step_ = 0;  // taken off it each tick
};

}  // namespace palpate
