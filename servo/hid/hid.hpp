// SPDX-License-Identifier: Apache-2.0
// servo/hid/hid.hpp: the HID devices of this machine, and channels to them, by hidapi and hidraw.
//
// hidapi lists all devices and opens those of libusb; a node of hidraw is opened here (hidraw_node.hpp). It is loaded
// when a function here is first called (base/module.hpp). It has two back ends: the kernel's hidraw, which knows usages
// and needs rights to /dev/hidraw*, and libusb, which takes a device from the kernel, knows no usages and needs rights
// to /dev/bus/usb. Threads: one thread at a time lists or opens; a port as report_port.hpp says. Linux.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/descriptor.hpp"
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

// Throws Error as openHidrawNode() does (hidraw_node.hpp); of libusb kDevice with what hidapi says, and as listHid().
[[nodiscard]] std::unique_ptr<ReportPort> openHid(const std::string& path, HidBackEnd back_end = HidBackEnd::kHidraw);

// For a process that may not open devices itself: from now on nodes of hidraw are opened so. It throws as
// openHidrawNode() does. Before any other call.
using HidrawOpener = std::function<Descriptor(const std::string& path)>;
void openHidrawBy(HidrawOpener opener);

// Loads, for good, the table by which hidapi's libusb reads a device's names (iconv): for a process that soon may load
// nothing, modules apart.
void loadHidNames() noexcept;

// hidapi's version; throws as listHid().
[[nodiscard]] std::string hidapiVersion(HidBackEnd back_end = HidBackEnd::kHidraw);

}  // namespace palpate
