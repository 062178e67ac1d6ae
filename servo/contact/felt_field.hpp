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

#include "servo/contact/edit_ease.hpp"
#include "servo/contact/felt_surface.hpp"
#include "servo/contact/lattice_spline.hpp"

namespace palpate {

class FeltField {
 public:
  explicit FeltField(double rate_hz) noexcept : value_ahead_(rate_hz), gradient_ahead_W_(rate_hz) {}

  // `below_m` under the felt point, which has a window. `number`: as for LatticeSpline. Once per tick.
  template <class Number>
  [[nodiscard]] LatticeSpline::At at(const FeltPoint& felt, double below_m, const Number& number) noexcept {
    const Vec3 p_W = felt.now_W - below_m * felt.normal_W;
    LatticeSpline::At at = places_[0].at(*felt.window, p_W, number);
    if (felt.roughness > kMeanFrom) {
      LatticeSpline::At sum = at;
      for (std::size_t i = 0; i < 6; ++i) {
        const Vec3 way_W = i % 2 == 0 ? felt.patch_W[i / 2] : Vec3(-felt.patch_W[i / 2]);
        const double bent_m = 0.5 * way_W.dot(felt.shape.apply(way_W));
        const LatticeSpline::At there = places_[i + 1].at(*felt.window, p_W + way_W - bent_m * felt.normal_W, number);
        sum.value += there.value;
        sum.gradient_W += there.gradient_W;
      }
      const double share = std::min(1.0, (felt.roughness - kMeanFrom) / (kAllMean - kMeanFrom));
      at.value += share * (sum.value / 7 - at.value);
      at.gradient_W += share * (sum.gradient_W / 7 - at.gradient_W);
    }
    return eased(felt, p_W, at);
  }

  void release() noexcept {
    for (LatticeSpline& place : places_) place.forget();
    value_ahead_.end();
    gradient_ahead_W_.end();
    has_last_ = false;
  }

 private:
  static constexpr double kMeanFrom = 0.05, kAllMean = 0.3;  // roughness at which the mean begins, and is all [-]

  // After an edit the field goes on from where it was.
  [[nodiscard]] LatticeSpline::At eased(const FeltPoint& felt, const Vec3& p_W, LatticeSpline::At at) noexcept {
    if (felt.edited && has_last_) {
      value_ahead_.take(at.value - last_.value - last_.gradient_W.dot(p_W - last_p_W_));
      gradient_ahead_W_.take(at.gradient_W - last_.gradient_W);
    }
    last_ = at;
    at.value -= value_ahead_.elapse();
    at.gradient_W -= gradient_ahead_W_.elapse();
    last_p_W_ = p_W;
    has_last_ = true;
    return at;
  }

  std::array<LatticeSpline, 7> places_;
  EditLead<double> value_ahead_;  // by how much the field as it is is ahead of what is felt
  EditLead<Vec3> gradient_ahead_W_;
  LatticeSpline::At last_;  // as it was, uneased
  Vec3 last_p_W_ = Vec3::Zero();
  bool has_last_ = false;
};

}  // namespace palpate
