// SPDX-License-Identifier: Apache-2.0
// servo/contact/friction.hpp: static, dynamic and viscous friction: the VHIP is held back on the plane.
//
// The model is a sled without mass. A spring of stiffness K draws it along the surface behind the tool
// (sliding_spring.hpp). |t| is the spring's stretch, D the depth, K D the normal load:
// - The sled sticks while |t| <= mu_s D (the spring's force lies within the friction cone).
// - Then it slips until the spring's force is mu_d K D + b_v m / T. m is its motion in this tick, found implicitly from
//   K (|t| - mu_d D - m) = b_v m / T, m >= 0.
// - It sticks again as soon as it does not move (m = 0, or slower than kStill).
// So steady slip at speed v costs exactly mu_d K D + b_v v. D is the depth of the incoming VHIP, along the plane's
// normal. The VHIP is held back by t, and the spring's energy t^2 / 2 is added to what is passed on. Slip only shortens
// t, so friction only takes energy. A push of earlier effects along the surface does not stretch the spring. It pushes
// the hand, and friction holds the hand back against it.
//
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

  [[nodiscard]] bool operator==(const FrictionParameters&) const = default;
};

class Friction final : public ContactEffect {
 public:
  static constexpr double kStill = 1e-6;  // slower than this counts as rounding, not motion [m/s]

  // `stiffness_N_per_m`: K of the contact. All parameters finite and not negative (effects.hpp checks).
  Friction(const FrictionParameters& parameters, double stiffness_N_per_m, double rate_hz) noexcept;

  [[nodiscard]] bool feelsSurface() const noexcept override { return false; }
  void release() noexcept override;
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  double static_ratio_, dynamic_ratio_;
  double share_;    // of the excess over mu_d D that the sled moves in a tick: K / (K + b_v / T) [-]
  double still_m_;  // kStill, per tick [m]
  SlidingSpring spring_;
  bool slipping_ = false;
};

}  // namespace palpate
