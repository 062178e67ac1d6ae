// SPDX-License-Identifier: Apache-2.0
// servo/contact/edit_ease.hpp: takes in what an edit changes at a contact evenly over kTime_s, not at once.
//
// EditEase is for a quantity that pushes. The whole is the quantity that pushes: the depth behind a plane [m], or a
// force [N]. What is shown is the whole less an amount. What an edit adds goes into the amount, so the shown quantity
// goes on as it was. For a free tool it begins at zero. The amount drains in equal steps, within kTime_s after the last
// addition. A later addition never slows the draining. The amount never exceeds the whole, so nothing pulls, and a tool
// that comes out by itself needs no more easing. What an edit takes away is not eased. So through edits the shown
// quantity rises by at most E / ticks() a tick, with E the largest amount that there was.
//
// EditLead is for all else that an edit changes, or the end of a groove: normals, curvatures, fields. It holds how far
// the thing as it is now is ahead of the thing as it is shown, of any sign, and drains by the same rule. A lead knows
// no whole: of a depth it must be kept within the depth, by bound().
// Thread: the servo's; no heap, lock, system call or throw. Cost: a few additions, only in ticks with an amount.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace palpate {

class EditEase {
 public:
  static constexpr double kTime_s = 0.5;

  explicit EditEase(double rate_hz) noexcept : ticks_(std::max(1.0, std::round(kTime_s * rate_hz))) {}

  // An edit has changed the quantity from `shown` to `whole`, with the tool at one place. An increase of up to
  // `negligible` is not taken for the edit's.
  void take(double shown, double whole, double negligible = 0) noexcept {
    const double added = whole - shown - amount_;
    if (added > 0 && added <= negligible) return;
    amount_ = std::max(0.0, amount_ + added);
    step_ = amount_ > 0 ? std::max(step_, amount_ / ticks_) : 0;
  }
  // Call once a tick, after take(). `whole`: the quantity in this tick; 0 (no contact) ends the easing.
  void elapse(double whole) noexcept {
    amount_ = std::max(0.0, std::min(amount_ - step_, whole));
    if (amount_ == 0) step_ = 0;
  }
  void end() noexcept { amount_ = step_ = 0; }

  [[nodiscard]] bool active() const noexcept { return amount_ > 0; }
  [[nodiscard]] double amount() const noexcept { return amount_; }  // the part of the whole that is not shown yet
  [[nodiscard]] double ticks() const noexcept { return ticks_; }    // ticks in which an amount drains

 private:
  double ticks_;
  double amount_ = 0;
  double step_ = 0;  // by which the amount shrinks in each tick
};

// `Quantity`: a double, or a vector or matrix of Eigen.
template <class Quantity>
class EditLead {
 public:
  explicit EditLead(double rate_hz) noexcept : ticks_(EditEase(rate_hz).ticks()) { end(); }

  // An edit has changed the thing by `turn`. One that is not finite is not taken.
  void take(const Quantity& turn) noexcept {
    if (!std::isfinite(size(turn))) return;
    lead_ += turn;
    step_ = std::max(step_, size(lead_) / ticks_);
  }
  // Call once a tick, after take(). Gives what is to be taken off the thing as it is.
  const Quantity& elapse() noexcept {
    if (!active()) return lead_;
    const double size_before = size(lead_);
    if (size_before > step_) {
      lead_ *= 1 - step_ / size_before;
    } else {
      end();
    }
    return lead_;
  }
  // The lead is no larger than this from now on.
  void bound(double most) noexcept {
    const double present = size(lead_);
    if (!(present > most)) return;
    if (most > 0) {
      lead_ *= most / present;
    } else {
      end();
    }
  }
  void end() noexcept {
    lead_ = zero();
    step_ = 0;
  }
  [[nodiscard]] bool active() const noexcept { return step_ > 0; }

 private:
  static Quantity zero() noexcept {
    if constexpr (std::is_arithmetic_v<Quantity>)
      return 0;
    else
      return Quantity::Zero();
  }
  static double size(const Quantity& quantity) noexcept {
    if constexpr (std::is_arithmetic_v<Quantity>)
      return std::abs(quantity);
    else
      return quantity.norm();
  }

  double ticks_;
  Quantity lead_;
  double step_;  // by which the lead shrinks in each tick
};

}  // namespace palpate
