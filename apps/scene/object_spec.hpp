// SPDX-License-Identifier: Apache-2.0
// apps/scene/object_spec.hpp: what a scene says of one solid object beside the volume.
//
// SI units, world frame W. The table in apps/scene/object_table.cpp gives each member its key, screen unit and help.
#pragma once

#include <string>

#include "base/vec.hpp"

namespace palpate {

enum class ObjectKind { kPlane, kSphere, kBox, kMesh };

struct ObjectSpec {
  ObjectKind kind = ObjectKind::kPlane;
  Vec3 position_W = Vec3::Zero();      // a point of the plane, the centre, or where a mesh file's origin goes [m]
  Vec3 normal_W = Vec3::UnitZ();       // of the plane; points out of the solid half-space
  double radius_m = 5e-3;              // of the sphere [m]
  Vec3 size_m = Vec3::Constant(0.01);  // of the box: whole edges [m]
  Vec3 rotation_deg =
      Vec3::Zero();         // about the world's x, then y, then z axis: R = Rz Ry Rx, around `position` [degree]
  std::string file;         // of the mesh
  std::string unit = "mm";  // of the mesh's file: mm, cm, m or in
  double scale = 1;         // of the mesh, in addition to its unit [-]
};

}  // namespace palpate
