// SPDX-License-Identifier: Apache-2.0
// apps/stability/wall_volume.hpp: volumes that stand for a wall: one window holds each whole, without Vulkan.
//
// plane: the object is below z = 0; the density is the distance from it in millimetres. A trilinear field and its
// gradients hold such a plane exactly, but for rounding to float.
// ball: a ball of kRadius_m whose highest point is the origin, for what a plane cannot show.
// Both fill a cube of kSide voxels of 1 mm around the origin. World frame W [m]. Any thread; the constructor samples
// the volume and makes its mesh.
#pragma once

#include <memory>

#include "apps/sampled/sampled_volume.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

class WallVolume {
 public:
  enum class Shape { kPlane, kBall };
  explicit WallVolume(Shape shape);

  static constexpr double kIsovalue = 0;
  static constexpr double kVoxel_m = 1e-3;
  static constexpr int kSide = 32;
  static constexpr double kRadius_m = 11e-3;

  // Publishes the whole volume as the exchange's first window, at time 0.
  void publish(WindowExchange& exchange) const;
  // What algorithms are made from, beside their parameters.
  [[nodiscard]] const std::shared_ptr<const ContactObject>& isosurface() const noexcept { return isosurface_; }
  [[nodiscard]] DensityScale scale() const noexcept { return volume_.scale(); }

 private:
  SampledVolume volume_;
  std::shared_ptr<const ContactObject> isosurface_;
};

}  // namespace palpate
