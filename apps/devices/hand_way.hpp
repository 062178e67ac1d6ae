// SPDX-License-Identifier: Apache-2.0
// apps/devices/hand_way.hpp: where a hand moved a handle, and whether that is what its user was asked to do.
//
// An arm that is another one than its user says, or that was calibrated elsewhere, tells another way than the hand
// went, or another length. So a hand moves the handle right, up and towards its user, and the arm must say the same.
// Frame D, the device's: x to the right, y up, z towards the user. Units: m, s. One thread. No heap, no errors.
#pragma once

#include <limits>
#include <optional>

#include "base/vec.hpp"

namespace palpate {

// Along the axis of D in which the hand went furthest.
struct HandWay {
  int axis = 0;
  bool positive = true;
  double length_m = 0;
};
[[nodiscard]] HandWay handWay(const Vec3& way_D) noexcept;
// "right", "left", "up", "down", "towards you", "away from you".
[[nodiscard]] const char* wordOf(const HandWay& way) noexcept;

// What a user is asked to do: right, up, towards you, by about so much each [m]. From the middle it stays within the
// workspace of each arm, whose radius is 0.1 m, and no hand trembles by as much.
inline constexpr double kAsked_m = 0.06;
// Whether the hand went so along this axis; a user's measure may be off by half.
[[nodiscard]] bool isAsked(const HandWay& way, int axis) noexcept;

// Waits for a hand that rests, moves, and rests again.
class HandMove {
 public:
  static constexpr double kLeast_m = 0.02;  // a shorter way is none: the hand has not gone yet where it was asked to
  static constexpr double kRest_m = 2e-3;   // a hand that rests stays within this, since it trembles a little
  static constexpr double kRest_s = 0.3;    // for so long; one that only slows down or turns round moves on before
  // A position of the handle at a time of the device's. Its way, once it rests again.
  [[nodiscard]] std::optional<Vec3> look(const Vec3& position_D, double time_s) noexcept;

 private:
  std::optional<Vec3> from_D_;
  Vec3 rest_D_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  double rests_s_ = 0;
};

}  // namespace palpate
