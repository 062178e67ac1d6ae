// SPDX-License-Identifier: Apache-2.0
// apps/bench/copy_speed.hpp: how fast this machine copies memory, which no filter can beat: what kernels are held
// against. A device on the CPU: memcpy by as many threads as the machine has, which are as many as the driver takes.
// Any other: the device's own copy of a buffer. Thread: the Gpu's. Memory: twice the bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/rivals/rival.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

class CopySpeed {
 public:
  CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads);
  CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads, bool on_host);  // for tests: either way on any device

  RunCost run();
  [[nodiscard]] bool isDone();  // whether every byte is there; fetches them from a device
  [[nodiscard]] double movedBytes() const noexcept { return 2.0 * static_cast<double>(bytes_); }  // read and written
  [[nodiscard]] const std::string& way() const noexcept { return way_; }                          // in words

 private:
  void copyOnHost();

  std::size_t bytes_;
  unsigned threads_;
  std::string way_;
  std::vector<std::byte> from_, to_;
  std::optional<gpu::Transfer> transfer_;  // of a device's copy
  std::optional<gpu::Buffer> device_from_, device_to_;
  std::optional<gpu::Commands> commands_;
};

}  // namespace palpate
