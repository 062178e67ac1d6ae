// SPDX-License-Identifier: Apache-2.0
// apps/bench/copy_speed.hpp: measures how fast the Vulkan device copies memory. No filter can be faster, so kernels are
// compared with it. For a device on the CPU: memcpy by as many threads as the machine has, like the driver. For any
// other: the device's own copy of a buffer. Thread: the Gpu's. Memory: twice the bytes.
#pragma once

#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "apps/rivals/rivals.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

class CopySpeed {
 public:
  CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads) : CopySpeed(gpu, bytes, threads, gpu.info().isCpu()) {}
  CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads, bool on_host)  // for tests: either way on any device
      : bytes_(bytes), threads_(threads), from_(bytes, std::byte{1}), to_(bytes) {  // written, so every page is there
    const double mib = static_cast<double>(bytes) / 1048576.0;
    way_ = on_host ? fmt::format("memcpy of {:g} MiB by {} threads", mib, threads)
                   : fmt::format("the device's copy of a buffer of {:g} MiB", mib);
    if (on_host) return;
    device_from_.emplace(gpu, "copied from", bytes, gpu::MemoryKind::kDevice);
    device_to_.emplace(gpu, "copied to", bytes, gpu::MemoryKind::kDevice);
    transfer_.emplace(gpu);
    transfer_->upload(from_, *device_from_);
    transfer_->upload(to_, *device_to_);
    commands_.emplace(gpu, "copy", 1);
  }

  RunCost run() {
    if (!commands_) return costOf([&] { copyOnHost(); });
    commands_->begin();
    commands_->copy(*device_from_, 0, *device_to_, 0, bytes_);
    return costOf([&] { commands_->run(); });
  }
  [[nodiscard]] bool isDone() {  // whether every byte was copied; downloads them from a device
    if (transfer_) transfer_->download(*device_to_, to_);
    return from_ == to_;
  }
  [[nodiscard]] double movedBytes() const noexcept { return 2.0 * static_cast<double>(bytes_); }  // read and written
  [[nodiscard]] const std::string& way() const noexcept { return way_; }                          // in words

 private:
  void copyOnHost() {
    std::vector<std::jthread> threads;
    const std::size_t share = (bytes_ + threads_ - 1) / threads_;
    for (std::size_t first = 0; first < bytes_; first += share) {
      threads.emplace_back([this, first, count = std::min(share, bytes_ - first)] {
        std::memcpy(to_.data() + first, from_.data() + first, count);
      });
    }
  }

  std::size_t bytes_;
  unsigned threads_;
  std::string way_;
  std::vector<std::byte> from_, to_;
  std::optional<gpu::Transfer> transfer_;  // this and the next three: only for a device's own copy
  std::optional<gpu::Buffer> device_from_, device_to_;
  std::optional<gpu::Commands> commands_;
};

}  // namespace palpate
