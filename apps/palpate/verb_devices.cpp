// SPDX-License-Identifier: Apache-2.0
// palpate devices: the Vulkan devices of this machine, best first.
#include <fmt/format.h>

#include "engine/gpu/gpu.hpp"
#include "verbs.hpp"

namespace palpate {

void addDevicesVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("devices", "list the Vulkan devices of this machine, best first");
  verb->callback([] {
    fmt::print("{:<44} {:<11} {:<9} {:>10}  {}\n", "device", "type", "Vulkan", "memory", "driver");
    bool chosen = false;
    for (const gpu::GpuInfo& info : gpu::listGpus()) {
      fmt::print("{:<44} {:<11} {:<9} {:>6.1f} GiB  {}", info.name, info.type, info.api_version,
                 static_cast<double>(info.memory_bytes) / 1073741824.0, info.driver);
      if (!info.unusable.empty()) fmt::print("  [unusable: {}]", info.unusable);
      if (info.unusable.empty() && !chosen) fmt::print("  [default]");
      chosen = chosen || info.unusable.empty();
      fmt::print("\n");
    }
  });
}

}  // namespace palpate
