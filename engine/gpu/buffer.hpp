// SPDX-License-Identifier: Apache-2.0
// engine/gpu/buffer.hpp: a storage buffer and its memory. Move-only; freed with its owner. Set-up code.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
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
  // Over memory of the host, which is its content and outlives it: what a kernel writes is there without a copy. kHost.
  // Empty: the driver takes no such memory, or not this (it begins and ends at whole pages).
  [[nodiscard]] static std::optional<Buffer> over(Gpu& gpu, std::string name, void* memory, std::size_t bytes);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] void* mapped() const noexcept;  // null if the host cannot access it

  struct State;
  [[nodiscard]] const State& state() const noexcept { return *state_; }

 private:
  explicit Buffer(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

}  // namespace palpate::gpu
