// SPDX-License-Identifier: Apache-2.0
// base/rotation.hpp: rotations as people give them: three angles in degrees.
#pragma once

#include <Eigen/Geometry>

#include "base/units.hpp"
#include "base/vec.hpp"

namespace palpate {

// Rz Ry Rx: turns about the world's x axis, then its y axis, then its z axis.
[[nodiscard]] inline Mat3 rotationOf(const Vec3& rotation_deg) {
  const Vec3 angle = rotation_deg / kDegreesPerRadian;
  return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace palpate
