// SPDX-License-Identifier: Apache-2.0
// apps/touch/scene_device.hpp: the haptic device that a scene names, ready for the servo: simulated, or a real one,
// found, opened and put into the scene.
//
// Set-up code. Throws Error: as makeDevice(), chooseHid() and PlacedDevice do.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/scene/scene.hpp"
#include "base/lattice.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/placed_device.hpp"

namespace palpate {

// Whether a person holds the scene's device.
[[nodiscard]] bool isHeld(const Scene& scene);
// Whether a path leads it: nobody holds it, and no recording is played back.
[[nodiscard]] bool hasPath(const Scene& scene);

// Where a volume lies in the world.
struct VolumeBox {
  Vec3 middle_W = Vec3::Zero();
  Vec3 half_W = Vec3::Zero();  // half its extent along the world's axes [m]
};
[[nodiscard]] VolumeBox boxOf(const Lattice& lattice, const Eigen::Vector3i& size);

// What the scene leaves open is chosen for the volume: the middle of the workspace is its middle, and the workspace
// holds all of it. A device that begins where it is put (SpaceMouse) is put in front of it.
[[nodiscard]] Placement placementOf(const Scene& scene, const DeviceLimits& device, const VolumeBox& box);

struct SceneDevice {
  std::unique_ptr<Device> device;
  std::optional<Placement> placement;  // of a device that is held
};
// `path` leads a simulated device.
[[nodiscard]] SceneDevice makeSceneDevice(const Scene& scene, const Path& path, const VolumeBox& box);

}  // namespace palpate
