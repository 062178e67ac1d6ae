// SPDX-License-Identifier: Apache-2.0
// base/vec.hpp: the vector types that all rooms share. Positions are double; samples are float (ARCHITECTURE.md,
// "Frames, units, precision").
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

using Vec3 = Eigen::Vector3d;   // a position or direction; the name of a variable says its frame (hip_W) and unit
using Mat3 = Eigen::Matrix3d;   // a rotation or reflection R_AB: takes B coordinates to A coordinates
using Vec3i = Eigen::Vector3i;  // voxel counts and voxel indices [voxel]

}  // namespace palpate
