// SPDX-License-Identifier: Apache-2.0
// engine/gpu/buffer_state.hpp: the Vulkan side of a Buffer. Private to engine/gpu.
#pragma once

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {

struct Buffer::State {
  Gpu::State* gpu = nullptr;
  std::string name;
  std::size_t bytes = 0;
  vk::raii::DeviceMemory memory = nullptr;  // declared first, so freed last: after the buffer bound to it
  vk::raii::Buffer buffer = nullptr;
  void* mapped = nullptr;

  ~State() {
    if (gpu != nullptr) gpu->bytes_in_use -= bytes;
  }
};

}  // namespace palpate::gpu
