// SPDX-License-Identifier: Apache-2.0
#include "device_arguments.hpp"

#include "apps/devices/device_table.hpp"
#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "verbs.hpp"

namespace palpate {

void addDeviceFlags(CLI::App& verb, const DeviceFlags& flags) {
  const auto help = [](const char* key) { return std::string(optionOfKey(key)->help); };
  verb.add_option("--device", flags.device, help("device.name"))
      ->type_name("NAME")
      ->check([](const std::string& name) -> std::string {
        try {
          static_cast<void>(deviceKindNamed(name));
        } catch (const Error& error) {
          return error.what();
        }
        return {};
      });
  verb.add_option("--device-path", flags.path, help("device.path"))->type_name("PATH")->check(notEmpty);
  verb.add_option_function<std::string>(
          "--hid", [&by_libusb = flags.by_libusb](const std::string& word) { by_libusb = word == "libusb"; },
          help("device.hid"))
      ->check(CLI::IsMember({"hidraw", "libusb"}));
}

}  // namespace palpate
