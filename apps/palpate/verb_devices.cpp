// SPDX-License-Identifier: Apache-2.0
// palpate devices: the haptic devices that Palpate knows and which of them are here, and the Vulkan devices of this
// machine, best first.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "apps/devices/choose_hid.hpp"
#include "base/error.hpp"
#include "engine/gpu/gpu.hpp"
#include "servo/devices/registry.hpp"
#include "servo/hid/hid.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

void printHapticDevices() {
  printResult("{:<44} {}\n", "haptic device (--device)", "what it is");
  for (const std::string& name : deviceNamesForUsers()) {
    const DeviceKind* kind = deviceKindNamed(name);
    const bool is_default = name == devices().front().name;
    const std::string what = kind != nullptr ? kind->what : std::string(deviceEntry(name).description);
    const std::string origin = kind != nullptr && !kind->file.empty() ? fmt::format("  [{}]", kind->file) : "";
    printResult("{:<44} {}{}{}\n", name, what, is_default ? "  [default]" : "", origin);
  }
  for (const std::string& complaint : deviceKindComplaints()) tellUser(complaint);
}

std::string kindsOf(const HidInfo& device) {
  std::string names;
  for (const DeviceKind& kind : knownDeviceKinds()) {
    if (fitOf(kind, device) == Fit::kYes) names += (names.empty() ? "" : " or ") + kind.name;
  }
  return names;
}

// Only those that can be chosen; `palpate doctor` shows all.
void printHidDevices() {
  std::vector<HidInfo> found;
  try {
    found = listHid();
  } catch (const Error& error) {
    printResult("\nHID devices cannot be listed: {}\n", error.what());
    return;
  }
  std::erase_if(found, [](const HidInfo& device) { return kindsOf(device).empty(); });
  if (found.empty()) {
    printResult("\nNone of them but the simulated one is here ('palpate doctor' says more).\n");
    return;
  }
  printResult("\n{:<44} {:<11} {}\n", "here (--device-path)", "USB", "name, and what it can be");
  for (const HidInfo& device : found) {
    printResult("{:<44} {:<11} {}: {}\n", device.path, usbText(device.vendor, device.product), device.name,
                kindsOf(device));
  }
}

void printVulkanDevices() {
  printResult("\n{:<44} {:<11} {:<9} {:>10}  {}\n", "Vulkan device (--gpu)", "type", "Vulkan", "memory", "driver");
  bool chosen = false;
  for (const gpu::GpuInfo& info : gpu::listGpus()) {
    printResult("{:<44} {:<11} {:<9} {:>6.1f} GiB  {}", info.name, info.type, info.api_version,
                static_cast<double>(info.memory_bytes) / 1073741824.0, info.driver);
    if (!info.unusable.empty()) printResult("  [unusable: {}]", info.unusable);
    if (info.unusable.empty() && !chosen) printResult("  [default]");
    chosen = chosen || info.unusable.empty();
    printResult("\n");
  }
}

// Of the families: what a table of the user's may set.
void printValues() {
  for (const DeviceEntry& entry : devices()) {
    if (!entry.needs_port) continue;
    printResult("{}: {}\n", entry.name, entry.description);
    printResult("  {:<26} {:<9} {:>10} {:>23}  {}\n", "value", "unit", "usual", "range", "what it is");
    for (const DeviceParameter& p : entry.parameters()) {
      printResult("  {:<26} {:<9} {:>10g} {:>23}  {}\n", p.key, p.unit, p.usual,
                  fmt::format("{:g} to {:g}{}", p.lowest, p.highest, p.is_whole ? ", whole" : ""), p.help);
    }
  }
}

}  // namespace

void addDevicesVerb(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("devices", "list haptic devices, and the Vulkan devices of this machine, best first");
  const auto values = std::make_shared<bool>(false);
  verb->add_flag("--values", *values, "list what a table of a device of your own may set instead (docs/devices.md)");
  verb->callback([values] {
    if (*values) return printValues();
    printHapticDevices();
    printHidDevices();
    printVulkanDevices();
  });
}

}  // namespace palpate
