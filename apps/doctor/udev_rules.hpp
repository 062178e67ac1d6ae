// SPDX-License-Identifier: Apache-2.0
// apps/doctor/udev_rules.hpp: the rights to use haptic devices, as a file of udev rules.
//
// One thread.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "apps/devices/device_table.hpp"

namespace palpate {

// The rule for one pair of USB numbers, by hidraw and by libusb: two lines.
[[nodiscard]] std::string udevRule(std::uint16_t vendor, std::uint16_t product);

// A rule for each pair of USB numbers of the kinds: whoever sits at the machine may use the device, by hidraw and by
// libusb.
[[nodiscard]] std::string udevRules(std::span<const DeviceKind> kinds);

inline constexpr const char* kUdevRulesFile = "/etc/udev/rules.d/70-palpate.rules";

// Whether the file holds this rule, among others.
[[nodiscard]] bool hasUdevRule(const std::filesystem::path& file, const std::string& rule);

// Writes the file and asks udev to read it. Throws Error(kIo): no right to write there (with the command that has it).
void installUdevRules(const std::filesystem::path& file, const std::string& rules);

}  // namespace palpate
