// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/wall_volume.hpp"

#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

constexpr double kDensityPerMetre = 1000;

double density(WallVolume::Shape shape, const Vec3& p_W) {
  if (shape == WallVolume::Shape::kPlane) return -kDensityPerMetre * p_W.z();
  const Vec3 centre_W(0, 0, -WallVolume::kRadius_m);
  return kDensityPerMetre * (WallVolume::kRadius_m - (p_W - centre_W).norm());
}

// The origin lies between samples, so that no effect of the lattice is left out.
Lattice latticeAroundOrigin() {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(WallVolume::kVoxel_m);
  lattice.origin_W = -WallVolume::kVoxel_m * Vec3(15.3, 15.6, 18.4);
  return lattice;
}

Volume volumeOf(WallVolume::Shape shape) {
  return volumeOfDensity(Vec3i::Constant(WallVolume::kSide), latticeAroundOrigin(),
                         shape == WallVolume::Shape::kPlane ? "a plane" : "a ball",
                         [&](const Vec3& p_W) { return density(shape, p_W); });
}

}  // namespace

WallVolume::WallVolume(Shape shape)
    : volume_(volumeOf(shape), kIsovalue),
      isosurface_(std::make_shared<const MeshObject>(volume_.isosurface(), "isosurface")) {}

void WallVolume::publish(WindowExchange& exchange) const {
  SampleWindow& window = exchange.back();
  volume_.gather({.first = Vec3i::Zero(), .size = Vec3i::Constant(kSide)}, exchange.backSamples(), window);
  window.stamp_ns = 0;
  exchange.publish();
}

}  // namespace palpate
