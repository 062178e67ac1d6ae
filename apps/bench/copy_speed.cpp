// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/copy_speed.hpp"

#include <cstring>
#include <thread>

#include <fmt/format.h>

namespace palpate {

CopySpeed::CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads)
    : CopySpeed(gpu, bytes, threads, gpu.info().isCpu()) {}

CopySpeed::CopySpeed(gpu::Gpu& gpu, std::size_t bytes, unsigned threads, bool on_host)
    : bytes_(bytes), threads_(threads) {
  const double mib = static_cast<double>(bytes) / 1048576.0;
  from_.resize(bytes, std::byte{1});  // written, so that every page is there
  to_.resize(bytes);
  if (on_host) {
    way_ = fmt::format("memcpy of {:g} MiB by {} threads", mib, threads);
    return;
  }
  device_from_.emplace(gpu, "copied from", bytes, gpu::MemoryKind::kDevice);
  device_to_.emplace(gpu, "copied to", bytes, gpu::MemoryKind::kDevice);
  transfer_.emplace(gpu);
  transfer_->upload(from_, *device_from_);
  transfer_->upload(to_, *device_to_);
  commands_.emplace(gpu, "copy", 1);
  way_ = fmt::format("the device's copy of a buffer of {:g} MiB", mib);
}

RunCost CopySpeed::run() {
  if (!commands_) return costOf([&] { copyOnHost(); });
  commands_->begin();
  commands_->copy(*device_from_, 0, *device_to_, 0, bytes_);
  return costOf([&] { commands_->run(); });
}

bool CopySpeed::isDone() {
  if (transfer_) transfer_->download(*device_to_, to_);
  return from_ == to_;
}

void CopySpeed::copyOnHost() {
  std::vector<std::jthread> threads;
  const std::size_t share = (bytes_ + threads_ - 1) / threads_;
  for (std::size_t first = 0; first < bytes_; first += share) {
    threads.emplace_back([this, first, count = std::min(share, bytes_ - first)] {
      std::memcpy(to_.data() + first, from_.data() + first, count);
    });
  }
}

}  // namespace palpate
