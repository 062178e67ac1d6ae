// SPDX-License-Identifier: Apache-2.0
// apps/devices/motor_stamp.hpp: remembers that a device's motors were checked (palpate calibrate --check).
//
// Leads and plugs do not change when an arm is switched off, so the stamp lies in the user's state folder and holds
// until somebody removes it, or the device is driven as another kind or with other values of its kind. It names the
// device by its serial number; where that is empty, by the USB port that it is plugged into: another one of its kind at
// that port passes as this one. Calibrations come and go without it (calibration_stamp.hpp). Any thread. A system
// without a home folder keeps none.
#pragma once

#include <filesystem>
#include <string>

#include "apps/devices/device_stamp.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {

struct CheckedAs {
  std::string kind;
  std::string usb;    // "1234:0006"
  std::string place;  // serial number, or port
  DeviceValues values = {};
};

class MotorStamp {
 public:
  explicit MotorStamp(const CheckedAs& device);
  [[nodiscard]] bool isThere() const { return stamp_.isThere(); }
  // Before a check: what was found out before does not hold any more.
  void remove() const { stamp_.remove(); }
  // False: it could not be kept.
  bool put() const { return stamp_.put(); }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return stamp_.file(); }  // empty: none can be kept

 private:
  DeviceStamp stamp_;
};

}  // namespace palpate
