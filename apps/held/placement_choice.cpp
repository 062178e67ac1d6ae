// SPDX-License-Identifier: Apache-2.0
#include "apps/held/placement_choice.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr double kInFront_m = 0.01;

Eigen::Matrix3d turned(const Vec3& about_rad) {
  return (Eigen::AngleAxisd(about_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(about_rad.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(about_rad.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace

VolumeBox boxOf(const Lattice& lattice, const Eigen::Vector3i& size) {
  Vec3 low = lattice.toWorld(Vec3::Zero()), high = low;
  for (int corner = 1; corner < 8; ++corner) {
    const Vec3 far = (size - Eigen::Vector3i::Ones()).cast<double>();
    const Vec3 at(corner & 1 ? far.x() : 0, corner & 2 ? far.y() : 0, corner & 4 ? far.z() : 0);
    low = low.cwiseMin(lattice.toWorld(at));
    high = high.cwiseMax(lattice.toWorld(at));
  }
  return {0.5 * (low + high), 0.5 * (high - low)};
}

Placement placementOf(const Scene& scene, const DeviceLimits& device, const VolumeBox& box) {
  Placement placement;
  placement.R_WD = scene.place_turn_rad ? turned(*scene.place_turn_rad) : facingThePatient();
  placement.scale = 1;
  if (device.workspace_radius_m > 0) placement.scale = std::max(1.0, box.half_W.norm() / device.workspace_radius_m);
  if (scene.place_scale) placement.scale = *scene.place_scale;
  placement.at_W = box.middle_W;
  if (!device.follows_force) {
    const Vec3 to_user_W = placement.R_WD * Vec3::UnitZ();
    placement.at_W += (box.half_W.cwiseProduct(to_user_W.cwiseAbs()).sum() + kInFront_m) * to_user_W;
  }
  if (scene.place_at_W) placement.at_W = *scene.place_at_W;
  placement.force_scale = scene.force_scale;
  placement.clutch = !scene.no_clutch;
  placement.edge_stiffness_N_per_m = scene.edge_stiffness_N_per_m;
  return placement;
}

}  // namespace palpate
