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

#include "engine/gpu/gpu_use.hpp"

namespace palpate::gpu {

// What is known of a Vulkan device before it is opened. Any thread may read it.
struct GpuInfo {
  std::string name;                     // "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string type;                     // "discrete", "integrated", "virtual", "cpu", "other"
  std::string tuned_as;                 // type of device that kernels are tuned for (GpuRequest::tuned_as)
  std::string driver;                   // driver name and version
  std::string api_version;              // "1.3.230"
  std::uint64_t memory_bytes = 0;       // of its largest device-local heap
  std::uint64_t max_binding_bytes = 0;  // of a storage buffer
  std::string unusable;                 // empty, or why Palpate cannot use it
  [[nodiscard]] bool isCpu() const noexcept { return type == "cpu"; }
};

// Every Vulkan device of this machine, best first (discrete, integrated, virtual, cpu). Throws Error(kNotFound) with
// the package to install if there is no loader or no driver.
[[nodiscard]] std::vector<GpuInfo> listGpus();

struct GpuRequest {
  std::string name{};       // part of a device's name, letter case ignored; empty: the best device
  std::string tuned_as{};   // type of device that kernels are tuned for; empty: the device's own type
  bool validation = false;  // open with the Khronos validation layer, synchronisation validation included
};

// Opens the device that a Gpu of this request will use, or finds it open, and keeps it open while the handle lives. For
// a thread that does so while another one still prepares its work: a driver takes some 30 ms. Throws as Gpu does.
[[nodiscard]] std::shared_ptr<const void> openAhead(const GpuRequest& request);

class Gpu {
 public:
  // Throws Error(kNotFound) if no device fits the request, kDevice if the driver refuses.
  explicit Gpu(const GpuRequest& request);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  [[nodiscard]] const GpuInfo& info() const noexcept;
  // The device was lost, or a kernel did not end: nothing more can be asked of it.
  [[nodiscard]] bool failed() const noexcept;
  [[nodiscard]] std::uint64_t bytesInUse() const noexcept;  // of all buffers [byte]
  [[nodiscard]] GpuUse use() const;

  struct State;  // vulkan_state.hpp
  [[nodiscard]] State& state() noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace palpate::gpu
