// SPDX-License-Identifier: Apache-2.0
// apps/held/placement_choice.hpp: where the device that a person holds lies in a volume. Any thread; no cost, no
// errors.
#pragma once

#include "apps/scene/scene.hpp"
#include "base/lattice.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/placed_device.hpp"

namespace palpate {

// Where a volume lies in the world.
struct VolumeBox {
  Vec3 middle_W = Vec3::Zero();
  Vec3 half_W = Vec3::Zero();  // half its extent along the world's axes [m]
};
[[nodiscard]] VolumeBox boxOf(const Lattice& lattice, const Eigen::Vector3i& size);

// What the scene leaves open is chosen for the volume: the middle of the workspace is its middle, and the workspace
// holds all of it. A device that begins where it is put (SpaceMouse) is put in front of it.
[[nodiscard]] Placement placementOf(const Scene& scene, const DeviceLimits& device, const VolumeBox& box);

}  // namespace palpate
