// SPDX-License-Identifier: Apache-2.0
// engine/gpu/buffer.hpp: a storage buffer and its memory. Move-only; freed with its owner. Set-up code.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "engine/gpu/gpu.hpp"

namespace palpate::gpu {

enum class MemoryKind {
  kDevice,  // fastest for kernels; mapped only if the device's memory is the host's (lavapipe)
  kHost,    // mapped, coherent and, if the device has such memory, cached: the host reads or writes it in place
};

class Buffer {
 public:
  // Throws Error(kOutOfMemory) if the device has too little memory left. `name`: for messages and debuggers.
  Buffer(Gpu& gpu, std::string name, std::size_t bytes, MemoryKind kind);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] void* mapped() const noexcept;  // null if the host cannot access it

  struct State;
  [[nodiscard]] const State& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace palpate::gpu
