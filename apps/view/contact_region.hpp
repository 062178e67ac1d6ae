// SPDX-License-Identifier: Apache-2.0
// apps/view/contact_region.hpp: the region of the object where the tool was in contact, for a camera.
//
// World frame [m]. Any thread. Cost: two passes over the records.
#pragma once

#include <vector>

#include "base/vec.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct ContactRegion {
  Vec3 centre_W = Vec3::Zero();   // [m]
  double radius_m = 0;            // of a sphere around all contact points, with a margin [m]
  Vec3 normal_W = Vec3::UnitZ();  // mean of the contact normals [-]
  Vec3 along_W = Vec3::UnitX();   // unit, normal to normal_W: from the first towards the last contact [-]
  std::vector<Vec3> points_W;     // some of the contact points, to test what a camera sees [m]
  bool touched = false;           // false: no contact; then the region is that of the whole path
  bool is_cut = false;            // edits have changed the surface, so the points may lie in a hollow
};

// `least_radius_m`: the smallest radius, so that a tap in one place is shown with its surroundings.
[[nodiscard]] ContactRegion findContactRegion(const std::vector<TickRecord>& records, double least_radius_m);

}  // namespace palpate
