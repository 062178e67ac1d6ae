// SPDX-License-Identifier: Apache-2.0
// apps/devices/calibration_stamp.hpp: remembers that a device was calibrated, as long as it stays plugged in.
//
// A device that counts from where it was switched on cannot say whether somebody told it where that is. A stamp in the
// user's runtime folder says so. It names the device's file in /dev with its inode and the time of its making: a device
// that was unplugged has another file, even of the same name. It also says as what it was calibrated: another kind
// counts from another home. A machine that slept meanwhile may have cut the device's power. Any thread. A system
// without a runtime folder keeps no stamps.
#pragma once

#include <string>

#include "apps/devices/device_stamp.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {

// The device at `path`, driven as this kind with these values.
struct CalibratedAs {
  std::string path, kind;
  DeviceValues values = {};
};

// Of the device that is there now, whatever is there later.
class CalibrationStamp {
 public:
  explicit CalibrationStamp(const CalibratedAs& device);
  [[nodiscard]] bool isThere() const { return stamp_.isThere(); }
  // Whether it was there. Afterwards the device has none, of whatever kind.
  bool take();
  // False: it could not be kept, and the device must be calibrated again in the next run.
  bool put() const { return stamp_.put(); }

 private:
  DeviceStamp stamp_;
};

}  // namespace palpate
