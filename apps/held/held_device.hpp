// SPDX-License-Identifier: Apache-2.0
// apps/held/held_device.hpp: the device that a person holds and a scene names: found, opened and put into the volume.
//
// Set-up code. Throws Error: as chooseHid(), openHid(), makeDevice() and PlacedDevice do; kBadInput for a device that
// nobody knows.
#pragma once

#include <memory>

#include "apps/held/placement_choice.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/placed_device.hpp"

namespace palpate {

// Whether a person holds the scene's device.
[[nodiscard]] bool isHeld(const Scene& scene);

// Before the volume is loaded: if it is held, the device is there and may be used.
void checkHeldDevice(const Scene& scene);

struct HeldDevice {
  std::unique_ptr<Device> device;
  Placement placement;
};
[[nodiscard]] HeldDevice makeHeldDevice(const Scene& scene, const VolumeBox& box);

}  // namespace palpate
