// SPDX-License-Identifier: Apache-2.0
// engine/gpu/buffer.hpp: a storage buffer and its memory. Move-only; freed with its owner. Set-up code.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "engine/gpu/gpu.hpp"

namespace palpate::gpu {

enum class MemoryKind {
  kDevice,  // fastest for kernels; mapped only where the device's memory happens to be the host's (lavapipe)
  kHost,    // mapped, coherent and, where there is such memory, cached: the host reads or writes it in place
};

class Buffer {
 public:
  // Throws Error(kOutOfMemory) if the device has too little memory left. `name`: for messages and debuggers.
  Buffer(Gpu& gpu, std::string name, std::size_t bytes, MemoryKind kind);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] void* mapped() const noexcept;  // null where the host cannot reach it

  struct State;
  [[nodiscard]] const State& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace palpate::gpu
