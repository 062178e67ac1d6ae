// SPDX-License-Identifier: Apache-2.0
// apps/devices/calibration_stamp.hpp: remembers that a device was calibrated, as long as it stays plugged in.
//
// A device that counts from where it was switched on cannot say whether somebody told it where that is. A stamp in the
// user's runtime folder says so. It names the device's file in /dev with its inode and the time of its making: a device
// that was unplugged has another file, even of the same name. Any thread. A system without a runtime folder keeps no
// stamps.
#pragma once

#include <string>

namespace palpate {

[[nodiscard]] bool isStampedCalibrated(const std::string& device_path);
// False: it could not be kept, and the device must be calibrated again in the next run.
bool stampCalibrated(const std::string& device_path);

}  // namespace palpate
