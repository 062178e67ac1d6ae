// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/wall_volume.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/volume.hpp"
#include "engine/reference/dense_field.hpp"
#include "engine/reference/window.hpp"
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

Volume volumeOf(WallVolume::Shape shape, const Lattice& lattice) {
  VolumeFacts facts;
  facts.source = shape == WallVolume::Shape::kPlane ? "a plane" : "a ball";
  return Volume::fromBricks(
      Vec3i::Constant(WallVolume::kSide), lattice, std::move(facts), [&](const Vec3i& brick, float* values) {
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3i in_brick(n % kBrickSize, n / kBrickSize % kBrickSize, n / kBrickSize / kBrickSize);
          const Vec3i at = kBrickSize * brick + in_brick;
          values[n] = static_cast<float>(density(shape, lattice.toWorld(at.cast<double>())));
        }
        return false;
      });
}

}  // namespace

WallVolume::WallVolume(Shape shape) : lattice_(latticeAroundOrigin()) {
  const Volume volume = volumeOf(shape, lattice_);
  maximum_ = volume.maximum();
  isosurface_ = std::make_shared<const MeshObject>(isosurfaceMesh(volume, kIsovalue), "isosurface");
  samples_ = reference::windowSamples(reference::denseField(volume), Vec3i::Zero(), volume.size());
}

void WallVolume::publish(WindowExchange& exchange) const {
  SampleWindow& window = exchange.back();
  window.lattice = lattice_;
  window.size = Vec3i::Constant(kSide);
  window.low_is_border = window.high_is_border = {true, true, true};
  window.stamp_ns = 0;
  std::copy(samples_.begin(), samples_.end(), exchange.backSamples());
  exchange.publish();
}

}  // namespace palpate
