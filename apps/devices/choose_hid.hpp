// SPDX-License-Identifier: Apache-2.0
// apps/devices/choose_hid.hpp: which HID device of this machine is meant, and how it is opened, and opened again.
//
// Any thread, one at a time. Errors name the device, what is wrong with it and what to do.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/device_table.hpp"
#include "apps/devices/motor_stamp.hpp"
#include "servo/hid/hid.hpp"
#include "servo/hid/hidraw_node.hpp"

namespace palpate {

enum class Fit {
  kNo,          // other USB numbers
  kOtherUsage,  // its numbers, but it says that it is something else: the numbers are in use by other gadgets too
  kYes,
};
[[nodiscard]] Fit fitOf(const DeviceKind& kind, const HidInfo& device);

// Other kinds that a device may be instead: of the same family and USB numbers, so that nobody can tell from what it
// says.
[[nodiscard]] std::vector<DeviceKind> lookAlikes(const DeviceKind& kind, const HidInfo& device);

// The device of this kind; with a path, the one there. Throws Error: kNotFound if there is none, with what is there
// instead; kBadInput if there are several, or if the path's is another.
[[nodiscard]] const HidInfo& chooseHid(const DeviceKind& kind, std::span<const HidInfo> all, const std::string& path);

// A node of hidraw, opened, for whoever may not open one (service/broker): of a known kind by its USB numbers, which
// the kernel says, and so no keyboard and no security key. Throws Error as openHidrawNode() and numbersAt() do
// (servo/hid/hidraw_node.hpp), and as refuseUnknown().
[[nodiscard]] Descriptor openKnownNode(const std::string& path);
// Throws Error(kBadInput) for USB numbers that no known kind has (knownDeviceKinds()).
void refuseUnknown(const std::string& path, const HidNumbers& numbers);

struct HidChoice {
  HidInfo device;
  DeviceValues values;  // of the kind, and of these USB numbers
  [[nodiscard]] CalibratedAs asCalibrated() const { return {.path = device.path, .kind = kind, .values = values}; }
  std::string kind;  // its name
  // Of other kinds with these USB numbers, which it may be instead; and its motors, as this kind (motor_stamp.hpp).
  std::vector<DeviceValues> look_alikes;
  [[nodiscard]] CheckedAs asChecked() const;
  // Opens the device for this program alone (hid_lock.hpp); again after it was unplugged, wherever it is plugged in
  // then. It knows it by its serial number, if it has one, else by its kind.
  PortOpener open;
};
[[nodiscard]] HidChoice chooseHid(const DeviceKind& kind, const std::string& path, HidBackEnd back_end);

}  // namespace palpate
