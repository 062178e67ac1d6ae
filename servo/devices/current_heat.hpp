// SPDX-License-Identifier: Apache-2.0
// servo/devices/current_heat.hpp: how large a current may be that motors and amplifiers bear only for a while (I2t).
//
// What a current i heats fills like a vessel that leaks: h' = (i^2 - h) / heating_s, from 0. It is borne for ever at
// `continuous_A`, so h must stay within its square. The largest current is
//   i^2 <= C^2 + g (C^2 - h),   C = continuous_A,  g = heating_s / kFold_s - 1, at least 1.
// A cold motor may have several times C; as it warms the limit comes down to C within some kFold_s, evenly, so that the
// hand feels no step. At the limit h' = (1 + g) (C^2 - h) / heating_s: h comes near C^2 and never beyond, also in steps
// of up to heating_s / (1 + g).
// Units: A, s; h in A^2. One thread. Cost: an exponential. Errors, heap: none.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.hpp"

namespace palpate {

class CurrentHeat {
 public:
  static constexpr double kFold_s = 0.5;

  // `continuous_A` 0: any current is borne for ever.
  CurrentHeat(double continuous_A, double heating_s) noexcept
      : square_A2_(continuous_A * continuous_A), heating_s_(heating_s), gain_(std::max(1.0, heating_s / kFold_s - 1)) {}

  // These currents of motors a to c flowed for so long.
  void pass(const Vec3& currents_A, double time_s) noexcept {
    if (!(square_A2_ > 0) || !(time_s > 0)) return;
    const double left = std::exp(-time_s / heating_s_);
    heat_A2_ = left * heat_A2_ + (1 - left) * currents_A.cwiseAbs2();
  }

  // What of these currents may flow now, of all alike [-].
  [[nodiscard]] double share(const Vec3& currents_A) const noexcept {
    double share = 1;
    if (!(square_A2_ > 0)) return share;
    for (int k = 0; k < 3; ++k) {
      const double most_A = std::sqrt(std::max(0.0, square_A2_ + gain_ * (square_A2_ - heat_A2_[k])));
      const double size_A = std::abs(currents_A[k]);
      if (size_A > most_A) share = std::min(share, most_A / size_A);
    }
    return share;
  }

 private:
  double square_A2_, heating_s_, gain_;
  Vec3 heat_A2_ = Vec3::Zero();
};

}  // namespace palpate
