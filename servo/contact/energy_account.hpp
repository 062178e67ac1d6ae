// SPDX-License-Identifier: Apache-2.0
// servo/contact/energy_account.hpp: what the effects give must have been put in: the last word on where the VHIP is.
//
// An effect with a potential gives back what it took. Some cannot have one: recovery keeps an old force while the tool
// goes on, so after a valley it pushes the hand along its way; force shading turns the force
// without changing the depth; in noise a plane jumps and with it what lies under the tool. So the account of a contact
// is kept, E: what the hand put in, by the effects' force over the tool's way (as a trapezoid of both ends, so that
// holding a force over a tick, which any sampled wall does, is not the effects' fault). Where the effects hold more in
// store than is in the account, the difference is a debt. It is paid twice over:
// - by a drag along the surface, a sled as friction's (sliding_spring.hpp), kRepayments debt / D behind the tool, at
//   most kMostDrag D: a way of D / kRepayments pays for most of it, and a drive along the way is cancelled;
// - by weakening: d is multiplied by (E + kFree of the largest energy in store) / U where that is less than 1. So at
//   the end of a contact no more than kFree of it has been given, and what the force of one tick did.
// Both are continuous where E and U are. What friction dissipates is credit, for this contact. What the plane alone
// gave, along the same way, times its stiffness, is not charged: effects make it no better and no worse.
// A wrong reading (isAWay) opens a new account.
// Source: passivity observer and controller (Hannaford and Ryu, 2002), here with the energy that a potential knows.
// Energies are over K: [m^2]. Frame W: world [m]. Thread: the servo's. Cost: some 5 ns.
#pragma once

#include "servo/contact/sliding_spring.hpp"

namespace palpate {

class EnergyAccount {
 public:
  static constexpr double kFree = 0.0025;    // of the largest energy stored in this contact [-]
  static constexpr double kRepayments = 8;   // of a debt, on a way as long as the depth [-]
  static constexpr double kShare = 0.1;      // of a change of drag or of the plane's gift, in each tick [-]
  static constexpr double kMostDrag = 0.25;  // of the depth [-]

  // The VHIP for what the effects want. Once a tick in contact, new_contact first.
  [[nodiscard]] Vec3 settle(const ContactState& contact, const ContactPush& push) noexcept;

 private:
  void open(const ContactState& contact, const ContactPush& push) noexcept;
  [[nodiscard]] double planesGift(const Vec3& way_W, const Vec3& plane_W, double stiffness) noexcept;

  SlidingSpring drag_;
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_d_W_ = Vec3::Zero();      // as it was given out
  Vec3 last_plane_W_ = Vec3::Zero();  // d of the plane alone
  double put_in_m2_ = 0;              // E / K
  double largest_m2_ = 0;             // U / K in this contact
  double debt_m2_ = 0;
  double longest_m_ = 0;        // the drag's stretch
  double plane_put_in_m2_ = 0;  // E / K of the plane alone
  double gift_m2_ = 0;          // what it gave, and is not charged
};

}  // namespace palpate
