// SPDX-License-Identifier: Apache-2.0
#include "apps/view/contact_region.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr std::size_t kMostPoints = 40;
constexpr double kRoom = 1.25;

// The unit vector normal to `normal` that is nearest to `wish`.
Vec3 across(const Vec3& normal, const Vec3& wish) {
  const Vec3 rest = wish - wish.dot(normal) * normal;
  return rest.norm() > 1e-9 ? Vec3(rest.normalized()) : Vec3(normal.unitOrthogonal());
}

}  // namespace

ContactRegion findContactRegion(const std::vector<TickRecord>& records, double least_radius_m) {
  ContactRegion region;
  region.radius_m = least_radius_m;
  region.touched = std::any_of(records.begin(), records.end(), [](const TickRecord& r) { return r.in_contact; });
  std::vector<Vec3> points_W;
  Vec3 normals = Vec3::Zero();
  for (const TickRecord& record : records) {
    if (region.touched && !record.in_contact) continue;
    points_W.push_back(asVec3(region.touched ? record.vhip_W : record.hip_W));
    normals += asVec3(record.normal_W);
  }
  if (points_W.empty()) return region;

  Vec3 low = points_W.front(), high = low;
  for (const Vec3& p : points_W) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  region.centre_W = (low + high) / 2;
  for (const Vec3& p : points_W) region.radius_m = std::max(region.radius_m, kRoom * (p - region.centre_W).norm());
  if (normals.norm() > 1e-9) region.normal_W = normals.normalized();
  region.along_W = across(region.normal_W, points_W.back() - points_W.front());
  const std::size_t stride = points_W.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < points_W.size(); i += stride) region.points_W.push_back(points_W[i]);
  return region;
}

}  // namespace palpate
