// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/udev_rules.hpp"

#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"

extern char** environ;

namespace palpate {
namespace {

// Without a udev there is nobody to ask; the rules are then read when one starts.
void runQuietly(std::initializer_list<const char*> words) {
  std::vector<char*> arguments;
  for (const char* word : words) arguments.push_back(const_cast<char*>(word));
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) == 0) waitpid(child, nullptr, 0);
}

}  // namespace

std::string udevRule(std::uint16_t vendor, std::uint16_t product) {
  return fmt::format(
      "KERNEL==\"hidraw*\", ATTRS{{idVendor}}==\"{0:04x}\", ATTRS{{idProduct}}==\"{1:04x}\", MODE=\"0660\", "
      "TAG+=\"uaccess\"\n"
      "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{0:04x}\", ATTR{{idProduct}}==\"{1:04x}\", MODE=\"0660\", "
      "TAG+=\"uaccess\"\n",
      vendor, product);
}

std::string udevRules(std::span<const DeviceKind> kinds) {
  std::set<std::pair<std::uint16_t, std::uint16_t>> ids;
  for (const DeviceKind& kind : kinds) {
    for (const UsbId& usb : kind.usb) ids.emplace(usb.vendor, usb.product);
  }
  std::string rules = "# Written by palpate doctor --install-udev: haptic devices for whoever sits at the machine.\n";
  for (const auto& [vendor, product] : ids) rules += udevRule(vendor, product);
  return rules;
}

bool hasUdevRule(const std::filesystem::path& file, const std::string& rule) {
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}).find(rule) != std::string::npos;
}

void installUdevRules(const std::filesystem::path& file, const std::string& rules) {
  try {
    writeFileAtomically(file, rules);
  } catch (const Error& error) {
    std::error_code ignored;
    const std::filesystem::path folder = file.parent_path();
    throw Error(Error::Code::kIo, file.string(), error.reason(),
                std::filesystem::exists(folder, ignored)
                    ? "run it with the right to write there: sudo palpate doctor --install-udev"
                    : fmt::format("sudo mkdir -p {} && sudo palpate doctor --install-udev", folder.string()));
  }
  runQuietly({"udevadm", "control", "--reload"});
  runQuietly({"udevadm", "trigger", "--subsystem-match=hidraw", "--subsystem-match=usb"});
}

}  // namespace palpate
