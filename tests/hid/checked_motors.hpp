// SPDX-License-Identifier: Apache-2.0
// Emulated arms whose motors were checked: as `palpate calibrate --check` leaves it behind.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "apps/devices/device_table.hpp"
#include "apps/devices/motor_stamp.hpp"

namespace palpate {

// For programs whose $XDG_STATE_HOME is this: the first two devices of emulate_hid, as Polhem v1.
inline void leaveCheckedMotors(const std::filesystem::path& state_home) {
  const char* before = std::getenv("XDG_STATE_HOME");
  const std::string kept = before != nullptr ? before : "";
  setenv("XDG_STATE_HOME", state_home.c_str(), 1);
  for (const DeviceKind& kind : deviceKinds({})) {
    if (kind.name != "polhem-v1") continue;
    for (const UsbId& usb : kind.usb) {
      DeviceValues values = kind.values;
      for (const auto& [key, value] : usb.values) values[key] = value;
      for (const char* serial : {"E0", "E1"}) {
        const MotorStamp stamp(
            {.kind = kind.name, .usb = usbText(usb.vendor, usb.product), .place = serial, .values = values});
        if (!stamp.put()) throw std::runtime_error("no stamp can be left in " + state_home.string());
      }
    }
  }
  if (before != nullptr)
    setenv("XDG_STATE_HOME", kept.c_str(), 1);
  else
    unsetenv("XDG_STATE_HOME");
}

}  // namespace palpate
