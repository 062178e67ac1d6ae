// SPDX-License-Identifier: Apache-2.0
// servo/contact/recovery.hpp: recovery time: a new plane moves the VHIP over a set time, not at once.
//
// When the plane is found again (age 0), the displacement d = VHIP - HIP would jump. The jump j is the d that the old
// plane gives at the present HIP, less the new d. It is added to an offset of d. Its share of the offset decays
// linearly to zero over exactly N ticks, the recovery time. Jumps superpose. So depth and direction of the VHIP are
// continuous over a switch. The force steps by at most K |j| / N per tick and jump. N ticks after the last switch d is
// the true one, to the bit.
// - The d of the old plane at the present HIP is the d of the last tick, less N_old (N_old . motion of the HIP since
//   then). For a plain plane that is its depth at the HIP.
// - If several planes hold the tool, now or in the last tick, the jump is not recorded; offsets go on decaying. There
//   the VHIP is continuous by itself (closest_in_planes.hpp), and no single normal says how the old planes would move
//   it.
// - A first contact is no switch: there is no displacement to keep.
// - A contact may end while jumps are kept. Then the force that they hold is gone in that tick. So no more of the
//   offset is felt, out of the surface or along it, than the largest jump and the depth: what is lost at an end is
//   about what one switch would have made. A jump is forgotten as by a low-pass filter of N ticks.
// - The offset never makes the depth negative. In a tick in which it would, as much of its normal part is left out as
//   needed. The VHIP then lies beside the HIP, and the contact neither pushes nor pulls along the normal.
//
// What it costs. On a surface of radius R, planes that are n ticks apart differ in depth by j = (v n T)^2 / (2 R) at a
// renewal. (About half of that with hri, which finds planes ahead of the tool.) Recovery keeps each j for (N + 1) / 2
// ticks in the mean, so the depth is off by j (N + 1) / (2 n). On an evenly curved surface the steps cannot fall below
// j / n. The direction lags by l, the motion of (N + 1) / 2 ticks. Where the surface is hollow along the motion, the
// force drives the tool on by l / R of itself; after a valley it does so for N ticks. The energy account takes that
// back (energy_account.hpp). It uses the credit of friction if there is some, else a drag, and weakens the force by up
// to 2 l / (R kRepayments).
//
// Offsets are whole multiples of 1e-18 m, so their sums have no rounding: nothing is left over and nothing drifts.
// Source: Mark et al. (SIGGRAPH 1996); the paper, section 3.3 and Figure 6. VRPN's plane.C restarts one ramp at every
// switch; here every jump has its own. Frame W: world [m]. Thread: move() and release() the servo's. Cost: some 15 ns;
// memory 24 bytes per tick of recovery, allocated in the constructor.
#pragma once

#include <cstdint>
#include <vector>

#include "servo/contact/contact_effect.hpp"

namespace palpate {

class Recovery final : public ContactEffect {
 public:
  static constexpr double kUnit = 1e-18;   // of the offset [m]
  static constexpr double kLongest = 0.1;  // a larger offset comes from no surface and is dropped [m]

  // `ticks`: N >= 1.
  explicit Recovery(int ticks);

  [[nodiscard]] bool feelsSurface() const noexcept override { return false; }
  void release() noexcept override;
  void move(const ContactState& contact, ContactPush& push) noexcept override;

  // The offset that is still added to d [m].
  [[nodiscard]] Vec3 offset() const noexcept { return offset_.cast<double>() * kUnit; }

 private:
  using Units = Eigen::Matrix<std::int64_t, 3, 1>;  // [kUnit]

  void forget() noexcept;
  void decay() noexcept;
  void takeUp(const Vec3& jump_W) noexcept;
  [[nodiscard]] Vec3 offsetAt(double depth_m, const Vec3& normal_W) const noexcept;

  std::int64_t ticks_;
  std::vector<Units> ending_;  // ring: for each slot, the shares that end in its tick
  std::size_t slot_ = 0;
  std::int64_t pending_ticks_ = 0;  // until the youngest jump has decayed
  Units offset_ = Units::Zero();
  Units slope_ = Units::Zero();  // the sum of the jumps' shares, taken off the offset each tick
  double largest_m_ = 0;         // jump that is not forgotten yet
  Vec3 last_d_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_normal_W_ = Vec3::Zero();
  bool last_single_ = false;  // one plane alone held the tool in the last tick
};

}  // namespace palpate
