// SPDX-License-Identifier: Apache-2.0
// apps/held/chosen_device.hpp: opens a device of this machine, and keeps for the next program whether it is calibrated.
//
// Whether its motors were checked, a stamp says too (apps/devices/motor_stamp.hpp), and nothing else can: without it
// the device is held below kUncheckedForce_N.
//   Its calibration stamp (apps/devices/calibration_stamp.hpp) is taken away before the device is told anything, so
// that none is left of a program that is killed or of a device that does not come to be. When the device is let go the
// stamp is put back, or made, if the device still counts from its home position and it was a stamp or its button that
// said so. Set-up code.
#pragma once

#include <memory>

#include "apps/devices/choose_hid.hpp"
#include "apps/devices/device_table.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {

// `setup` without an opener; its values take the place of the choice's. Throws Error as HidChoice::open and
// makeDevice() do.
[[nodiscard]] std::shared_ptr<Device> openChosenDevice(const DeviceKind& kind, HidChoice choice, DeviceSetup setup);

}  // namespace palpate
