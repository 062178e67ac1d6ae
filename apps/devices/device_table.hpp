// SPDX-License-Identifier: Apache-2.0
// apps/devices/device_table.hpp: the kinds of devices that can be chosen by name, as data.
//
// A kind is an entry of a TOML file: its name, the family whose code drives it (servo/devices/registry.hpp), its USB
// numbers, and the values that differ from the family's. The program brings devices.toml; files in the user's folder of
// configuration add kinds, or replace those of the same name. Any thread. Cost: reading devices.toml, some 0.3 ms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "servo/devices/registry.hpp"

namespace palpate {

struct UsbId {
  std::uint16_t vendor = 0, product = 0;
  DeviceValues values;  // of devices with these numbers alone
};

struct DeviceKind {
  std::string name;    // "polhem-v1": what --device takes
  std::string family;  // DeviceEntry::name
  std::string what;    // one line
  std::vector<UsbId> usb;
  std::optional<std::pair<std::uint16_t, std::uint16_t>> usage;  // page, usage of the HID report descriptor; empty: any
  DeviceValues values;
  std::string file;  // that it comes from; empty: the program's own

  [[nodiscard]] const UsbId* idOf(std::uint16_t vendor, std::uint16_t product) const noexcept;  // null: none
  // What each of its USB numbers has of a value; where nothing is stated, the family's usual one. Empty: the family has
  // no such value.
  [[nodiscard]] std::vector<double> eachValueOf(std::string_view key) const;
};

// "1234:0006".
[[nodiscard]] std::string usbText(std::uint16_t vendor, std::uint16_t product);

// The entries of a file's text. Throws Error(kBadInput), which names file, line and what is wrong: no TOML, an unknown
// key or family, a value that the family does not have or that is out of range, USB numbers that are none, a name that
// is empty, double, or that of a device without a bus.
[[nodiscard]] std::vector<DeviceKind> readDeviceKinds(std::string_view text, const std::string& file);

// The user's folder: $XDG_CONFIG_HOME/palpate/devices, or ~/.config/palpate/devices; empty: neither variable is set.
[[nodiscard]] std::filesystem::path userDeviceFolder();

// All kinds: the program's own, and those of the *.toml files in `folder`, in the order of their names. Throws as
// above.
[[nodiscard]] std::vector<DeviceKind> deviceKinds(const std::filesystem::path& folder);

// Those of the user's folder; a file that cannot be read leaves its kinds out, and `complaint()` says why.
[[nodiscard]] std::span<const DeviceKind> knownDeviceKinds();
[[nodiscard]] const std::vector<std::string>& deviceKindComplaints();

// Every name that --device takes: devices without a bus, then the kinds.
[[nodiscard]] const std::vector<std::string>& deviceNamesForUsers();

// Null: a device without a bus. Throws Error(kBadInput) for an unknown name.
[[nodiscard]] const DeviceKind* deviceKindNamed(const std::string& name);

}  // namespace palpate
