// SPDX-License-Identifier: Apache-2.0
// servo/contact/felt_field.hpp: a smooth field that is read at the felt surface: heights of a texture, factors of the
// stiffness.
//
// On a smooth surface it is the field of lattice_spline.hpp at the place. On a rough one it goes over to the mean of
// seven places, those of the patch from which the normal is found, each as far under the surface. What an edit changes
// is taken in evenly over EditEase::kTime_s.
// Frame W: world [m]. Thread: the servo's. Cost: that of a LatticeSpline; on a rough surface of seven. Errors: none.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "servo/contact/edit_ease.hpp"
#include "servo/contact/felt_surface.hpp"
#include "servo/contact/lattice_spline.hpp"

namespace palpate {

class FeltField {
 public:
  explicit FeltField(double rate_hz) noexcept : ease_ticks_(std::max(1.0, std::round(EditEase::kTime_s * rate_hz))) {}

  // `below_m` under the felt point, which has a window. `number`: as for LatticeSpline. Once per tick.
  template <class Number>
  [[nodiscard]] LatticeSpline::At at(const FeltPoint& felt, double below_m, const Number& number) noexcept {
    const Vec3 p_W = felt.now_W - below_m * felt.normal_W;
    LatticeSpline::At at = places_[0].at(*felt.window, p_W, number);
    if (felt.roughness > kSmooth) {
      LatticeSpline::At sum = at;
      for (std::size_t i = 0; i < 6; ++i) {
        const Vec3 way_W = i % 2 == 0 ? felt.patch_W[i / 2] : Vec3(-felt.patch_W[i / 2]);
        const double bent_m = 0.5 * way_W.dot(felt.shape.apply(way_W));
        const LatticeSpline::At there = places_[i + 1].at(*felt.window, p_W + way_W - bent_m * felt.normal_W, number);
        sum.value += there.value;
        sum.gradient_W += there.gradient_W;
      }
      const double share = std::min(1.0, (felt.roughness - kSmooth) / (kRough - kSmooth));
      at.value += share * (sum.value / 7 - at.value);
      at.gradient_W += share * (sum.gradient_W / 7 - at.gradient_W);
    }
    return eased(felt, p_W, at);
  }

  void release() noexcept {
    for (LatticeSpline& place : places_) place.forget();
    ahead_ticks_ = 0;
    has_last_ = false;
  }

 private:
  static constexpr double kSmooth = 0.05, kRough = 0.3;  // roughness at which the mean begins, and is all

  // After an edit the field goes on from where it was.
  [[nodiscard]] LatticeSpline::At eased(const FeltPoint& felt, const Vec3& p_W, LatticeSpline::At at) noexcept {
    if (felt.edited && has_last_) {
      ahead_.value = at.value - last_.value - last_.gradient_W.dot(p_W - last_p_W_);
      ahead_.gradient_W = at.gradient_W - last_.gradient_W;
      ahead_ticks_ = ease_ticks_;
    }
    if (ahead_ticks_ > 0) {
      const double left = 1 - 1 / ahead_ticks_;
      ahead_.value *= left;
      ahead_.gradient_W *= left;
      --ahead_ticks_;
      at.value -= ahead_.value;
      at.gradient_W -= ahead_.gradient_W;
    }
    last_ = at;
    last_p_W_ = p_W;
    has_last_ = true;
    return at;
  }

  std::array<LatticeSpline, 7> places_;
  double ease_ticks_;
  double ahead_ticks_ = 0;
  LatticeSpline::At ahead_, last_;
  Vec3 last_p_W_ = Vec3::Zero();
  bool has_last_ = false;
};

}  // namespace palpate
