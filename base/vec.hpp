// SPDX-License-Identifier: Apache-2.0
// base/vec.hpp: the vector types that all rooms share, and rotations as users give them.
//
// Positions are double; samples are float (ARCHITECTURE.md, "Frames, units, precision").
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/units.hpp"

namespace palpate {

using Vec3 = Eigen::Vector3d;   // a position or direction; the variable's name says its frame and unit (hip_W)
using Mat3 = Eigen::Matrix3d;   // a rotation or reflection R_AB: takes B coordinates to A coordinates
using Vec3i = Eigen::Vector3i;  // voxel counts and voxel indices [voxel]

// Rz Ry Rx of three angles in degrees: turns about the world's x axis, then its y axis, then its z axis.
[[nodiscard]] inline Mat3 rotationOf(const Vec3& rotation_deg) {
  const Vec3 angle = rotation_deg / kDegreesPerRadian;
  return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace palpate
