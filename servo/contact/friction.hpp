// SPDX-License-Identifier: Apache-2.0
// servo/contact/friction.hpp: static, dynamic and viscous friction: the VHIP is held back on the plane.
//
// A sled without mass is drawn along the surface by the spring K whose other end is the tool (sliding_spring.hpp), a
// distance |t| away. With the normal load K D:
// - it sticks while |t| <= mu_s D (the spring's force within the friction cone);
// - then it slips until the spring's force is mu_d K D + b_v m / T, m: its motion in this tick, found implicitly:
//   K (|t| - mu_d D - m) = b_v m / T, m >= 0;
// - it sticks again as soon as it does not move (m = 0; a sled slower than kStill stands still).
// So slipping steadily at speed v costs mu_d K D + b_v v exactly. D is that of the VHIP that comes in, along the
// plane's normal. The VHIP is held back by t; what the spring stores, t^2 / 2, is passed on. Slipping only shortens t,
// so friction only takes energy. What earlier effects push along the surface is not drawn by the spring: it pushes the
// hand, and friction holds the hand back against it.
// Sources: the paper, section 3 (friction limits the motion of the VHIP); Coulomb's law; a sled that sticks and slips
// as in Salcudean and Vlaar (1997), Hayward and Armstrong (2000). Frame W: world [m]. Thread: move() and release() the
// servo's. Cost: some 20 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/sliding_spring.hpp"

namespace palpate {

struct FrictionParameters {
  double static_ratio = 0;      // mu_s [-]
  double dynamic_ratio = 0;     // mu_d, at most mu_s [-]
  double viscous_Ns_per_m = 0;  // b_v, only while slipping
};

class Friction final : public ContactEffect {
 public:
  static constexpr double kStill = 1e-6;  // [m/s]; rounding must not look like motion

  // `stiffness_N_per_m`: K of the contact. All parameters finite and not negative (effects.hpp checks).
  Friction(const FrictionParameters& parameters, double stiffness_N_per_m, double rate_hz) noexcept;

  void release() noexcept override;
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  double static_ratio_, dynamic_ratio_;
  double share_;    // of the excess over mu_d D that the sled moves in a tick: K / (K + b_v / T) [-]
  double still_m_;  // in a tick
  SlidingSpring spring_;
  bool slipping_ = false;
};

}  // namespace palpate
