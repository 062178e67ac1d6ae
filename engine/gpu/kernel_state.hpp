// SPDX-License-Identifier: Apache-2.0
// engine/gpu/kernel_state.hpp: the Vulkan side of a Kernel. Private to engine/gpu.
#pragma once

#include "engine/gpu/kernel.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {

struct Kernel::State {
  std::string name;
  std::uint32_t bindings = 0;
  std::uint32_t push_bytes = 0;
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  vk::raii::Pipeline pipeline = nullptr;
};

}  // namespace palpate::gpu
