// SPDX-License-Identifier: Apache-2.0
// palpate devices: the haptic devices that Palpate knows, and the Vulkan devices of this machine, best first.
#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "engine/gpu/gpu.hpp"
#include "servo/devices/registry.hpp"
#include "verbs.hpp"

namespace palpate {

void addDevicesVerb(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("devices", "list haptic devices, and the Vulkan devices of this machine, best first");
  verb->callback([] {
    printResult("{:<44} {}\n", "haptic device (--device)", "what it is");
    for (const DeviceEntry& entry : devices()) {
      const bool is_default = &entry == &devices().front();
      printResult("{:<44} {}{}\n", entry.name, entry.description, is_default ? "  [default]" : "");
    }
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
  });
}

}  // namespace palpate
