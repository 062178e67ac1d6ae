// SPDX-License-Identifier: Apache-2.0
// servo/devices/registry.hpp: the haptic devices by name, with their parameters as data. A new one is files here, one
// of them NAME_entry.cpp; nothing outside this room names its type.
//
// Set-up only: allocates and throws.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "servo/devices/device.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/recording.hpp"
#include "servo/devices/report_port.hpp"

namespace palpate {

// A number that a device is made with.
struct DeviceParameter {
  std::string_view key;   // "hand_mass_kg": SI units
  std::string_view unit;  // "kg"; empty: none
  double usual = 0;       // its value if it is not given
  double lowest = 0, highest = 0;
  std::string_view help;
  bool is_whole = false;  // a count or a flag
};

using DeviceValues = std::map<std::string, double, std::less<>>;  // by DeviceParameter::key

// What a device is made from. Each takes what it needs.
struct DeviceSetup {
  const Path* path = nullptr;                            // leads a device that no real hand moves; outlives the device
  double rate_hz = 1000;                                 // of the servo [Hz]
  DeviceValues values = {};                              // parameters that are given; the others have their usual value
  PortOpener open = {};                                  // for a device on a bus
  std::shared_ptr<const Recording> recording = nullptr;  // to be played back
  bool simulated_clock = false;
  bool calibrated = false;                     // since it was switched on; for a device that must be
  bool motors_checked = false;                 // each pulls the right way, as this kind (motor_check.hpp)
  std::vector<DeviceValues> look_alikes = {};  // of arms that it may be instead, as nobody can tell from its reports
  std::function<void()> thread_begins = {};    // called first in each thread that the device has of its own
};

struct DeviceEntry {
  std::string_view name;
  std::string_view description;  // one line
  bool needs_path = false;       // DeviceSetup::path must be given
  bool needs_pointer = false;    // the path is where a window's pointer leads
  bool needs_port = false;       // DeviceSetup::open must be given; the device has a frame of its own, D
  std::span<const DeviceParameter> (*parameters)() = nullptr;
  std::unique_ptr<Device> (*make)(const DeviceSetup& setup) = nullptr;
  // Throws Error(kBadInput) for values that no such device can have, each within its range; null: all can be.
  void (*check)(const DeviceValues& values) = nullptr;
};

// The first is the default.
[[nodiscard]] std::span<const DeviceEntry> devices() noexcept;

// Throws Error(kBadInput) on an unknown name (the message names the known ones).
[[nodiscard]] const DeviceEntry& deviceEntry(std::string_view name);

// Throws std::logic_error for a key that the device does not have: keys are written in code, not by users.
[[nodiscard]] const DeviceParameter& deviceParameter(std::string_view device, std::string_view key);

// Throws Error(kBadInput) on an unknown name, a value out of range, a value for a parameter that the device does not
// have, a missing path, and what the device itself refuses.
[[nodiscard]] std::unique_ptr<Device> makeDevice(std::string_view name, const DeviceSetup& setup);

}  // namespace palpate
