// SPDX-License-Identifier: Apache-2.0
// engine/gpu/gpu.hpp: one Vulkan device, opened for compute. Knows nothing of volumes.
//
// Vulkan's own types stay inside engine/gpu (vulkan_state.hpp); other code sees Buffer, Kernel and Commands.
// Thread: one thread at a time uses a Gpu and everything made from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/gpu_info.hpp"

namespace palpate::gpu {

// Every Vulkan device of this machine, best first (discrete, integrated, virtual, cpu). Throws Error(kNotFound) with
// the package to install where there is no loader or no driver.
[[nodiscard]] std::vector<GpuInfo> listGpus();

struct GpuRequest {
  std::string name{};       // part of a device's name, letter case ignored; empty: the best device
  std::string tuned_as{};   // type of device that kernels are tuned for; empty: the device's own
  bool validation = false;  // open with the Khronos validation layer, synchronisation validation included
};

class Gpu {
 public:
  // Throws Error(kNotFound) if no device fits the request, kDevice if the driver refuses.
  explicit Gpu(const GpuRequest& request);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  [[nodiscard]] const GpuInfo& info() const noexcept;
  [[nodiscard]] std::uint64_t bytesInUse() const noexcept;  // of all buffers [byte]

  struct State;  // vulkan_state.hpp
  [[nodiscard]] State& state() noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace palpate::gpu
