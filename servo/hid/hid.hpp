// SPDX-License-Identifier: Apache-2.0
// servo/hid/hid.hpp: the HID devices of this machine, and channels to them, by hidapi.
//
// hidapi is loaded when a function here is first called (base/module.hpp). It has two back ends: the kernel's hidraw,
// which knows usages and needs rights to /dev/hidraw*, and libusb, which takes a device from the kernel, knows no
// usages and needs rights to /dev/bus/usb. Threads: one thread at a time lists or opens; a port as report_port.hpp
// says. Linux.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "servo/devices/report_port.hpp"

namespace palpate {

enum class HidBackEnd { kHidraw, kLibusb };

struct HidInfo {
  std::string path = {};  // "/dev/hidraw0"; of libusb "1-1:1.0"
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t usage_page = 0, usage = 0;  // 0: not told
  int interface_number = -1;                // -1: not told
  std::uint16_t release = 0;
  std::string maker = {}, name = {}, serial = {};  // UTF-8, as the device says; may be empty
};

// Throws Error(kNotFound) without the module or hidapi, kDevice if hidapi cannot begin.
[[nodiscard]] std::vector<HidInfo> listHid(HidBackEnd back_end = HidBackEnd::kHidraw);

// Throws Error(kDevice): no rights (with the rule that gives them), gone, or what hidapi says.
[[nodiscard]] std::unique_ptr<ReportPort> openHid(const std::string& path, HidBackEnd back_end = HidBackEnd::kHidraw);

// hidapi's version; throws as listHid().
[[nodiscard]] std::string hidapiVersion(HidBackEnd back_end = HidBackEnd::kHidraw);

}  // namespace palpate
