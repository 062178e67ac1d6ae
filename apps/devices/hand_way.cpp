// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/hand_way.hpp"

#include <array>
#include <cstddef>

namespace palpate {

HandWay handWay(const Vec3& way_D) noexcept {
  HandWay way{.length_m = way_D.norm()};
  way_D.cwiseAbs().maxCoeff(&way.axis);
  way.positive = way_D[way.axis] > 0;
  return way;
}

bool isAsked(const HandWay& way, int axis) noexcept {
  // Of what was asked. A user who has no ruler at hand may be off by half. Narrower bounds refuse the arm of such a
  // user; wider ones take more arms with other links for it (FindsArmsThatAreNamedAsAnother in motor_check_test.cpp).
  constexpr double kShortest = 0.6, kLongest = 1.6;
  return way.axis == axis && way.positive && way.length_m >= kShortest * kAsked_m &&
         way.length_m <= kLongest * kAsked_m;
}

std::optional<Vec3> HandMove::look(const Vec3& position_D, double time_s) noexcept {
  if (!((position_D - rest_D_).norm() <= kRest_m)) {
    rest_D_ = position_D;
    rests_s_ = time_s;
  }
  if (time_s - rests_s_ < kRest_s) return {};
  if (!from_D_) from_D_ = position_D;
  const Vec3 way_D = position_D - *from_D_;
  if (way_D.norm() < kLeast_m) return {};
  return way_D;
}

const char* wordOf(const HandWay& way) noexcept {
  constexpr std::array<std::array<const char*, 2>, 3> kWords = {
      {{"left", "right"}, {"down", "up"}, {"away from you", "towards you"}}};
  return kWords[static_cast<std::size_t>(way.axis)][way.positive ? 1 : 0];
}

}  // namespace palpate
