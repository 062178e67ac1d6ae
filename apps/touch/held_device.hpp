// SPDX-License-Identifier: Apache-2.0
// apps/touch/held_device.hpp: what a user of a real device must know at the start and at the end of a run.
//
// Set-up code; any thread.
#pragma once

#include <string>
#include <vector>

#include "apps/report/touch_run.hpp"
#include "apps/scene/scene.hpp"
#include "apps/touch/scene_device.hpp"
#include "servo/devices/device.hpp"

namespace palpate {

// Before the volume is loaded: the scene's device is there and may be used. Throws Error: as chooseHid() and openHid()
// do; kBadInput for a device that nobody knows.
void checkDevice(const Scene& scene);

// A scene that asks for no stiffness of its own, or for the usual one, gets at most what the device's maker states and
// the device can render at its rate, with its friction and delay.
void settleStiffness(Scene& scene, const Device& device);

// How the device lies in the scene, why it exerts no force, if it does not, and what its maker advises against.
[[nodiscard]] std::vector<std::string> heldDeviceWords(const Scene& scene, const Device& device,
                                                       const Placement& placement);

[[nodiscard]] RunDevice heldDevice(const std::string& kind, const Device& device);

}  // namespace palpate
