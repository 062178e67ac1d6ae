// SPDX-License-Identifier: Apache-2.0
// A table of devices as a user may write it. Each kind that is accepted has a name, a family, USB numbers, and values
// that the family takes.
#include "apps/devices/device_table.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void checkValues(const DeviceKind& kind, const DeviceValues& values) {
  for (const auto& [key, value] : values) {
    const DeviceParameter& p = deviceParameter(kind.family, key);
    fuzz::require(value >= p.lowest && value <= p.highest, "a value out of range is accepted: " + key);
  }
}

void check(const std::string& text) {
  std::vector<DeviceKind> kinds;
  if (!fuzz::accepts("table.toml", [&] { kinds = readDeviceKinds(text, "table.toml"); })) return;
  for (const DeviceKind& kind : kinds) {
    fuzz::require(!kind.name.empty() && !kind.what.empty() && !kind.usb.empty(), "a part is missing");
    fuzz::require(deviceEntry(kind.family).needs_port, "a family without a bus is accepted");
    checkValues(kind, kind.values);
    for (const UsbId& usb : kind.usb) {
      checkValues(kind, usb.values);
      fuzz::require(kind.idOf(usb.vendor, usb.product) != nullptr, "its numbers are not found");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
