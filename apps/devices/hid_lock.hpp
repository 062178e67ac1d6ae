// SPDX-License-Identifier: Apache-2.0
// apps/devices/hid_lock.hpp: a HID device for one program of Palpate at a time.
//
// Linux lets any number of programs write to one device by hidraw: a second one that only looks would take away, every
// other millisecond, the force that the first one asks for. So a name of the kernel's (an abstract Unix socket) is held
// as long as the port is open, and no longer than the process lives, for all users of the machine. Programs in
// different network namespaces, as in two containers, do not see each other's. Set-up code, and the link's thread when
// a device comes back.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "servo/hid/hid.hpp"

namespace palpate {

// A device by hidraw ("/dev/hidraw0") and by libusb ("1-2:1.0") has one name, that of its USB port, where it has one.
// `sys`: where /sys is.
[[nodiscard]] std::string hidLockName(const std::string& device, const std::filesystem::path& sys = "/sys");

// Where it is plugged in, "1-2.3", by hidraw and by libusb; the path itself where that is not known.
[[nodiscard]] std::string hidPortName(const std::string& device, const std::filesystem::path& sys = "/sys");

// Throws Error as openHid() does, and kDevice if another program holds the device, with which one.
[[nodiscard]] std::unique_ptr<ReportPort> openHidAlone(const std::string& path, HidBackEnd back_end);

}  // namespace palpate
