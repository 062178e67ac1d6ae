// SPDX-License-Identifier: Apache-2.0
// engine/gpu/gpu_info.hpp: what is known of a Vulkan device before it is opened. Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace palpate::gpu {

struct GpuInfo {
  std::string name;                     // "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string type;                     // "discrete", "integrated", "virtual", "cpu", "other"
  std::string tuned_as;                 // the kind of device whose tuning kernels take: type, or what the request says
  std::string driver;                   // driver name and version
  std::string api_version;              // "1.3.230"
  std::uint64_t memory_bytes = 0;       // of its largest device-local heap
  std::uint64_t max_binding_bytes = 0;  // of a storage buffer
  std::string unusable;                 // empty, or why Palpate cannot use it
  [[nodiscard]] bool isCpu() const noexcept { return type == "cpu"; }
};

}  // namespace palpate::gpu
