// SPDX-License-Identifier: Apache-2.0
// servo/hid/hidraw_node.hpp: a HID device by the kernel's hidraw, opened in one place and used in another. Linux.
//
// hidapi opens a device and uses it; a servo that has given up its rights cannot open one (service/broker).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/descriptor.hpp"
#include "servo/devices/report_port.hpp"

namespace palpate {

// Opens a node of hidraw, "/dev/hidraw0", and nothing else whatever the path says. Set-up code, any thread. Throws
// Error: kBadInput for a path that is none, or at which something else lies; kNotFound if it is not there (any more);
// kDevice without the right to use it, with the rule that gives it, or for the system's reason.
[[nodiscard]] Descriptor openHidrawNode(const std::string& path);

struct HidNumbers {
  std::uint16_t vendor = 0, product = 0;  // of USB, or what stands for them on another bus
};

// What the kernel says of an open node. Throws Error(kDevice) if it says nothing, as of what is no node.
[[nodiscard]] HidNumbers numbersAt(const Descriptor& node, const std::string& path);

// A port at an open node. Threads and blocking as report_port.hpp says.
[[nodiscard]] std::unique_ptr<ReportPort> portAt(Descriptor node);

}  // namespace palpate
