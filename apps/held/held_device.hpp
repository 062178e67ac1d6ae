// SPDX-License-Identifier: Apache-2.0
// apps/held/held_device.hpp: the device that a person holds and a scene names: found, opened and put into a volume.
//
// It is opened once for a program. What it knows of itself, as whether it is calibrated, it knows as long as it lives;
// so a window with one volume after another places the same device again. Set-up code. Throws Error: as chooseHid(),
// openHid(), makeDevice() and PlacedDevice do; kBadInput for a device that nobody knows or holds.
#pragma once

#include <memory>

#include "apps/held/placement_choice.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/placed_device.hpp"

namespace palpate {

// Whether a person holds the scene's device.
[[nodiscard]] bool isHeld(const Scene& scene);

// Before a volume is loaded: if it is held, the device is there and may be used.
void checkHeldDevice(const Scene& scene);

// In its own frame. Waits for its first report, for a second at most. When it is let go, it is noted for the next
// program whether it is calibrated (apps/devices/calibration_stamp.hpp).
[[nodiscard]] std::shared_ptr<Device> openHeldDevice(const Scene& scene);

struct HeldDevice {
  std::unique_ptr<Device> device;
  Placement placement;
};
[[nodiscard]] HeldDevice placeHeldDevice(std::shared_ptr<Device> device, const Scene& scene, const VolumeBox& box);

}  // namespace palpate
