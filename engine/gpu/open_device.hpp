// SPDX-License-Identifier: Apache-2.0
// engine/gpu/open_device.hpp: an open Vulkan device with the pipelines that were made on it. Every Gpu that asks for
// the same device shares it. Private to engine/gpu.
//
// Pipelines are the expensive part of a start: a driver compiles a shader for 0.1 to 1 s. So each kernel is made only
// once, however many Gpus ask for it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "engine/gpu/gpu.hpp"
#include "engine/gpu/kernel.hpp"

namespace palpate::gpu {

struct OpenDevice {
  // Parent before child: members are destroyed in the opposite order.
  GpuInfo info;  // tuned as its own type
  vk::raii::Context context;
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  std::uint32_t queue_family = 0;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;  // under one_at_a_time
  bool named = false;               // debug names are wanted
  std::size_t import_bytes = 0;     // to whose multiples memory of the host can be used in place; 0: it cannot

  // Name, bindings, bytes of push constants, specialisation; size and hash of the SPIR-V.
  using KernelKey =
      std::tuple<std::string, std::uint32_t, std::uint32_t, std::vector<std::uint32_t>, std::size_t, std::size_t>;
  std::map<KernelKey, std::shared_ptr<const Kernel::State>> kernels;  // under one_at_a_time
  std::mutex one_at_a_time;
};

// Opens a device, or returns it if it is open already. `name`: part of its name; empty: the best device. Throws as
// Gpu's constructor does. Any thread.
[[nodiscard]] std::shared_ptr<OpenDevice> openDevice(const std::string& name, bool validation);

}  // namespace palpate::gpu
