// SPDX-License-Identifier: Apache-2.0
// The emulated arm of the guest's devices: its path and what its report descriptor says.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "servo/devices/path.hpp"
#include "tests/hid/emulated_reports.hpp"
#include "tests/hid/kernel/guest_way.hpp"

namespace palpate {

inline std::vector<std::uint8_t> reportDescriptor(bool other_usage) {
  std::vector<std::uint8_t> usage = {0x06, 0xAB, 0xFF, 0x0A, 0x00, 0x02};
  if (other_usage) usage = {0x06, 0x00, 0xFF, 0x09, 0x01};
  const std::vector<std::uint8_t> rest = {0xA1, 0x01, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 14,
                                          0x09, 0x01, 0x81, 0x02, 0x95, 14,   0x09, 0x02, 0x91, 0x02, 0xC0};
  usage.insert(usage.end(), rest.begin(), rest.end());
  return usage;
}

// What both kinds of devices can be told to do, as words of their command lines.
struct GuestOptions {
  int count = 1, unplug_after = -1, silent_after = -1, replug_ms = 300;
  bool other_usage = false, silent = false;
  double faults = 0;
};
inline GuestOptions guestOptions(int count, char** words) {
  GuestOptions o;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&] { return i + 1 < count ? words[++i] : words[i]; };
    if (word == "--count") o.count = std::atoi(value());
    if (word == "--other-usage") o.other_usage = true;
    if (word == "--silent") o.silent = true;
    if (word == "--silent-after") o.silent_after = std::atoi(value());
    if (word == "--faults") o.faults = std::atof(value());
    if (word == "--unplug-after") o.unplug_after = std::atoi(value());
    if (word == "--replug-ms") o.replug_ms = std::atoi(value());
  }
  return o;
}

class GuestPolhem {
 public:
  explicit GuestPolhem(double faults = 0)
      : path_(guestWay()), arm_({}, HandParameters{}, path_, kGuestTick_s), reports_(arm_, faults, 1) {}
  [[nodiscard]] EmulatedPolhem& arm() { return arm_; }
  [[nodiscard]] EmulatedReports& reports() { return reports_; }

 private:
  SampledPath path_;
  EmulatedPolhem arm_;
  EmulatedReports reports_;
};

}  // namespace palpate
