// SPDX-License-Identifier: Apache-2.0
// engine/gpu/open_device.hpp: a Vulkan device that is open, shared by every Gpu that asked for the same one while it
// lives, with the pipelines that were made on it. Private to engine/gpu.
//
// Making a pipeline is the dear part of a start: a driver compiles its shader for 0.1 to 1 s. So each kernel is made
// once, whoever asks for it and however often.
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
  GpuInfo info;  // tuned as what it is
  vk::raii::Context context;
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  std::uint32_t queue_family = 0;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;  // under one_at_a_time
  bool named = false;               // debug names are wanted

  // Name, bindings, bytes of push constants, specialisation; size and hash of the SPIR-V.
  using KernelKey =
      std::tuple<std::string, std::uint32_t, std::uint32_t, std::vector<std::uint32_t>, std::size_t, std::size_t>;
  std::map<KernelKey, std::shared_ptr<const Kernel::State>> kernels;  // under one_at_a_time
  std::mutex one_at_a_time;
};

// The device of a name (part of it; empty: the best), opened unless it is open already. Throws as Gpu's constructor
// does. Any thread.
[[nodiscard]] std::shared_ptr<OpenDevice> openDevice(const std::string& name, bool validation);

}  // namespace palpate::gpu
