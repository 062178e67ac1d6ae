// SPDX-License-Identifier: Apache-2.0
// servo/devices/arm_kinematics.hpp: a capstan-driven arm of three joints, as WoodenHaptics and Polhem v1 have it.
//
// Body a turns about the vertical. It carries two parallel links: body b, turned by angle B from the vertical, and body
// c, by angle C from straight down. Each motor turns its body through a capstan; its encoder counts the motor's turns:
//   angle = s 2 pi count / counts_per_turn capstan / body,   s = -1 if the motor's axis is aligned with the body's.
//   x = cos A (Lb sin B + Lc sin C) - ox,  y = sin A (Lb sin B + Lc sin C) - oy,  z = La + Lb cos B - Lc cos C - oz.
// Frame A, the arm's: x towards the user, y to the right, z up; its origin, in the middle of the workspace, is at
// (ox, oy, oz) from the foot of the vertical axis. Units: m, rad, N, Nm, A. Source of form and constants:
// github.com/forsslund/haptikfabrikenapi (src/kinematics.cpp, src/haptikfabrikenapi.h); the Jacobian and the inverse
// are derived from the formulas above. Any thread, const after construction; no heap; no errors.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/vec.hpp"

namespace palpate {

struct ArmJoint {
  double capstan_m = 0.01, body_m = 0.18;  // diameters
  double length_m = 0.058;                 // of the body: height of the vertical axis, lengths of the links
  double torque_Nm_per_A = 0.0538;         // of the motor
  double counts_per_turn = 2000;           // of the motor, quadrupled
  bool aligned = true;                     // motor with body
};

using ArmCounts = std::array<std::int64_t, 3>;  // of encoders a to c, without the wrap of 16 bits [count]

class ArmKinematics {
 public:
  ArmKinematics(const std::array<ArmJoint, 3>& joints, const Vec3& origin_m) : joints_(joints), origin_m_(origin_m) {}

  [[nodiscard]] Vec3 angles(const ArmCounts& counts) const noexcept;                    // A, B, C
  [[nodiscard]] Vec3 position(const Vec3& angles) const noexcept;                       // in A
  [[nodiscard]] Eigen::Matrix3d jacobian(const Vec3& angles) const noexcept;            // of position, [m/rad]
  [[nodiscard]] Vec3 currents(const Vec3& force_A, const Vec3& angles) const noexcept;  // tau = J^T F, [A]
  // The force that currents exert; zero where the arm is stretched out and the Jacobian has no inverse.
  [[nodiscard]] Vec3 force(const Vec3& currents_A, const Vec3& angles) const noexcept;
  // The columns of J^-T, the forces of 1 Nm at each body; infinite where the arm is stretched out [1/m].
  [[nodiscard]] Eigen::Matrix3d pushes(const Vec3& angles) const noexcept;
  // The torque of each body for a current of its motor [Nm/A].
  [[nodiscard]] Vec3 bodyTorques() const noexcept;
  // The angles of a position, the elbow turned away from the user; empty: out of reach.
  [[nodiscard]] std::optional<Vec3> anglesAt(const Vec3& position_A) const noexcept;
  [[nodiscard]] ArmCounts countsAt(const Vec3& angles) const noexcept;  // rounded
  [[nodiscard]] double radPerCount(std::size_t joint) const noexcept;
  // The longest way of one count of any encoder, at these angles [m].
  [[nodiscard]] double resolution_m(const Vec3& angles) const noexcept;

 private:
  std::array<ArmJoint, 3> joints_;
  Vec3 origin_m_;
};

}  // namespace palpate
