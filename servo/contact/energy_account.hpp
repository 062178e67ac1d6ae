// SPDX-License-Identifier: Apache-2.0
// servo/contact/energy_account.hpp: lets the contact effects give back only energy that the hand put in. It acts after
// all effects and decides where the VHIP is.
//
// An effect with a potential gives back what it took. Some effects cannot have one. Recovery keeps an old force while
// the tool moves on, so after a valley it pushes the hand forward. Force shading turns the force without changing the
// depth. In noise the plane jumps, and the material under the tool jumps with it.
//
// The account of a contact keeps E: the energy that the hand put in against the effects' force. The force over a tick
// is the mean of its two ends (trapezoid rule). Holding a force over a tick, which every sampled wall does, adds energy
// too; the trapezoid rule does not charge that to the effects. Energy that friction dissipates is credit for this
// contact. Energy that the plane alone would have given over the same motion, times its stiffness, is not charged:
// effects make it neither better nor worse.
//
// If the effects store more energy U than the account holds, the difference is a debt. It is paid in two ways. Both are
// continuous where E and U are.
// - A drag along the surface: a sled as in friction (sliding_spring.hpp). It is kRepayments debt / D behind the tool
//   (D: depth), at most kMostDrag D. A motion of D / kRepayments pays for most of the debt. A force that drives the
//   tool along the surface is cancelled.
// - Weakening: d is multiplied by (E + kFree of the largest energy stored) / U if that is less than 1. So by the end of
//   a contact the effects have given at most that kFree part, and the work of one tick's force.
// The account opens with what the first tick of a contact stores. If that is less than half of the second tick's work,
// it opens with the second: else a contact that begins exactly on the surface would owe the error of its first step,
// and be weak to its end. A wrong reading (isTickMotion) opens a new account, too. Source: passivity observer and
// controller (Hannaford and Ryu, 2002), here with the energy that the potentials give. Energies are divided by K:
// [m^2]. Frame W: world [m]. Thread: the servo's. Cost: some 5 ns.
#pragma once

#include "servo/contact/sliding_spring.hpp"

namespace palpate {

class EnergyAccount {
 public:
  static constexpr double kFirstStep = 0.5;  // of the second tick's work [-]
  static constexpr double kFree = 0.0025;    // share of the largest stored energy that may be given [-]
  static constexpr double kRepayments = 8;   // how many times the debt a motion of one depth pays back [-]
  static constexpr double kShare = 0.1;      // how much of a change of drag or plane_given_m2_ a tick takes over [-]
  static constexpr double kMostDrag = 0.25;  // largest drag, as a share of the depth [-]

  // Gives the VHIP for the force, from the one that the effects want. Once per tick in contact; the first tick of a
  // contact has new_contact set.
  [[nodiscard]] Vec3 settle(const ContactState& contact, const ContactPush& push) noexcept;

 private:
  void open(const ContactState& contact, const ContactPush& push) noexcept;
  [[nodiscard]] double planeGiven(const Vec3& way_W, const Vec3& plane_W, double stiffness) noexcept;

  bool just_opened_ = false;  // this contact's first tick was the last
  SlidingSpring drag_;
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_d_W_ = Vec3::Zero();      // as settle() gave it
  Vec3 last_plane_W_ = Vec3::Zero();  // d of the plane alone
  double put_in_m2_ = 0;              // E / K, of the effects
  double largest_m2_ = 0;             // largest U / K in this contact
  double debt_m2_ = 0;
  double drag_limit_m_ = 0;     // of the drag [m]
  double plane_put_in_m2_ = 0;  // E / K of the plane alone
  double plane_given_m2_ = 0;   // what the plane alone gave; not charged
};

}  // namespace palpate
