// SPDX-License-Identifier: Apache-2.0
// engine/gpu/kernel.hpp: a compute pipeline: SPIR-V, its storage buffer bindings, push constants, specialisation.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/gpu.hpp"

namespace palpate::gpu {

struct KernelSpec {
  std::string name;                           // for messages and debuggers
  std::span<const std::uint32_t> spirv;       // only read during construction
  std::uint32_t bindings = 0;                 // storage buffers 0 ... bindings - 1, all in set 0
  std::uint32_t push_bytes = 0;               // <= 128
  std::vector<std::uint32_t> specialisation;  // constant_id 0, 1, ...
};

class Kernel {
 public:
  // Throws Error(kDevice) if the driver refuses the shader. Cost: the driver compiles the shader, but only once for
  // each SPIR-V and specialisation while a Gpu of the device lives.
  Kernel(Gpu& gpu, const KernelSpec& spec);
  ~Kernel();
  Kernel(Kernel&&) noexcept;
  Kernel& operator=(Kernel&&) noexcept;

  struct State;
  [[nodiscard]] const State& state() const noexcept { return *state_; }

 private:
  std::shared_ptr<const State> state_;
};

}  // namespace palpate::gpu
