// SPDX-License-Identifier: Apache-2.0
// servo/contact/recovery.hpp: recovery time: a new plane does not move the VHIP at once, but over a set time.
//
// When the plane is found again (age 0), the displacement d = VHIP - HIP would jump by j from what the old plane gives
// at the present HIP. The jump is taken up into an offset that is added to d, and decays linearly to zero over exactly
// N ticks, the recovery time. Jumps superpose. So the VHIP, depth and direction, is continuous over a switch, the force
// steps by at most K |j| / N per tick and jump, and N ticks after the last switch d is the true one, to the bit.
// - What the old plane gives: d moves by -N_old (N_old . motion of the HIP) there, so d_old(HIP now) is d of the last
//   tick and that; for a plain plane that is its depth at the HIP.
// - Where several planes hold the tool at once, the VHIP is continuous by itself (closest_in_planes.hpp), and how far
//   the old ones would let it move is not the part along one normal: nothing is taken up, what is pending goes on
//   decaying.
// - A first contact is no switch: there is no displacement to keep.
// - The offset never makes the depth negative: the part along the normal that would do so is left out in that tick, so
//   the VHIP then lies beside the HIP and the contact pushes no more; it does not pull.
// What it costs: on a surface of radius R, planes n ticks apart err in depth by j = (v n T)^2 / (2 R) when they are
// renewed (about half of that with hri, which finds them ahead of the tool), and recovery keeps each j for (N + 1) / 2
// ticks in the mean, so the depth is off by j (N + 1) / (2 n). Where the surface curves evenly the steps can only fall
// to j / n. The direction lags by l = (N + 1) / 2 ticks of way: where the surface is hollow along the way, the force
// drives the tool on by l / R of itself, and after a valley for N ticks. The energy account takes that back
// (energy_account.hpp): by friction, where there is some, else by a drag and up to 2 l / (R kRepayments) of the force.
// Offsets are whole numbers of 1e-18 m: sums of them have no rounding, so nothing is left over and nothing drifts.
// Source: Mark et al. (SIGGRAPH 1996), the paper, section 3.3 and Figure 6; the rule of VRPN's plane.C, which restarts
// one ramp at every switch, where here every jump has its own. Frame W: world [m]. Thread: move() and release() the
// servo's. Cost: some 15 ns; memory 24 bytes per tick of recovery, taken when it is made.
#pragma once

#include <cstdint>
#include <vector>

#include "servo/contact/contact_effect.hpp"

namespace palpate {

class Recovery final : public ContactEffect {
 public:
  static constexpr double kUnit = 1e-18;   // of the offset [m]
  static constexpr double kLongest = 0.1;  // [m]; a larger offset is no surface's: all is forgotten

  // `ticks`: N >= 1.
  explicit Recovery(int ticks);

  void release() noexcept override;
  void move(const ContactState& contact, ContactPush& push) noexcept override;

  // What is still added to d [m].
  [[nodiscard]] Vec3 offset() const noexcept { return offset_.cast<double>() * kUnit; }

 private:
  using Units = Eigen::Matrix<std::int64_t, 3, 1>;  // [kUnit]

  void forget() noexcept;
  void decay() noexcept;
  void takeUp(const Vec3& jump_W) noexcept;

  std::int64_t ticks_;
  std::vector<Units> ending_;  // ring: what stops being taken off the offset, in the tick of this slot
  std::size_t slot_ = 0;
  std::int64_t pending_ticks_ = 0;  // until the youngest jump has decayed
  Units offset_ = Units::Zero();
  Units slope_ = Units::Zero();  // taken off the offset each tick: the sum of the jumps' shares
  Vec3 last_d_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_normal_W_ = Vec3::Zero();
  bool last_single_ = false;  // the last tick's contact was one plane
};

}  // namespace palpate
