// SPDX-License-Identifier: Apache-2.0
// servo/contact/energy_account.hpp: lets the contact effects give back only energy that the hand put in. It has the
// last word on where the VHIP is.
// An effect with a potential gives back what it took. Some effects cannot have one. Recovery keeps an old force while
// the tool goes on, so after a valley it pushes the hand along its way. Force shading turns the force without changing
// the depth. In noise a plane jumps, and what lies under the tool jumps with it.
// So the account of a contact keeps E: the energy that the hand put in against the effects' force. The force over a
// tick is the mean of its two ends (trapezoid rule). So holding a force over a tick, which any sampled wall does, is
// not charged to the effects. What friction dissipates is credit for this contact. What the plane alone gave along the
// same way, times its stiffness, is not charged: effects make it no better and no worse.
// Where the effects store more energy U than the account holds, the difference is a debt. It is paid in two ways, both
// continuous where E and U are:
// - A drag along the surface: a sled as in friction (sliding_spring.hpp), kRepayments debt / D behind the tool, at most
//   kMostDrag D (D: depth). A way of D / kRepayments pays for most of the debt, and a drive along the way is cancelled.
// - Weakening: d is multiplied by (E + kFree of the largest energy stored) / U where that is less than 1. So by the end
//   of a contact the effects have given at most that kFree part, and what the force of one tick did.
// A wrong reading (isAWay) opens a new account.
// Source: passivity observer and controller (Hannaford and Ryu, 2002), here with the energy that the potentials give.
// Energies are over K: [m^2]. Frame W: world [m]. Thread: the servo's. Cost: some 5 ns.
#pragma once

#include "servo/contact/sliding_spring.hpp"

namespace palpate {

class EnergyAccount {
 public:
  static constexpr double kFree = 0.0025;    // of the largest energy stored in this contact [-]
  static constexpr double kRepayments = 8;   // times the debt that a way as long as the depth pays back [-]
  static constexpr double kShare = 0.1;      // of a change of the drag or of gift_m2_, taken over in each tick [-]
  static constexpr double kMostDrag = 0.25;  // of the depth [-]

  // Gives the VHIP that is shown, from the one that the effects want. Once per tick in contact; the first tick of a
  // contact has new_contact set.
  [[nodiscard]] Vec3 settle(const ContactState& contact, const ContactPush& push) noexcept;

 private:
  void open(const ContactState& contact, const ContactPush& push) noexcept;
  [[nodiscard]] double planesGift(const Vec3& way_W, const Vec3& plane_W, double stiffness) noexcept;

  SlidingSpring drag_;
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_d_W_ = Vec3::Zero();      // as settle() gave it
  Vec3 last_plane_W_ = Vec3::Zero();  // d of the plane alone
  double put_in_m2_ = 0;              // E / K, of the effects
  double largest_m2_ = 0;             // largest U / K in this contact
  double debt_m2_ = 0;
  double longest_m_ = 0;        // the drag's stretch
  double plane_put_in_m2_ = 0;  // E / K of the plane alone
  double gift_m2_ = 0;          // what the plane alone gave, which is not charged
};

}  // namespace palpate
