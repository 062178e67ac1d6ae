// SPDX-License-Identifier: Apache-2.0
// apps/palpate/device_arguments.hpp: which real device is meant, for verbs that have no scene.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

struct DeviceFlags {
  std::string& device;
  std::string& path;
  bool& by_libusb;
};

// --device, --device-path and --hid, with the words of a scene's options.
void addDeviceFlags(CLI::App& verb, const DeviceFlags& flags);

}  // namespace palpate
