// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/transfer.hpp"

#include <algorithm>
#include <cstring>

namespace palpate::gpu {
namespace {

constexpr std::size_t kStagingBytes = 16U << 20U;

}  // namespace

Transfer::Transfer(Gpu& gpu, bool in_place) : gpu_(gpu), in_place_(in_place), commands_(gpu, "transfer", 1) {}

Buffer& Transfer::staging() {
  if (!staging_) staging_.emplace(gpu_, "staging", kStagingBytes, MemoryKind::kHost);
  return *staging_;
}

void Transfer::upload(std::span<const std::byte> bytes, const Buffer& to, std::size_t offset) {
  if (bytes.empty()) return;
  if (reaches(to)) {
    std::memcpy(static_cast<std::byte*>(to.mapped()) + offset, bytes.data(), bytes.size());
    return;
  }
  for (std::size_t done = 0; done < bytes.size(); done += kStagingBytes) {
    const std::size_t part = std::min(kStagingBytes, bytes.size() - done);
    std::memcpy(staging().mapped(), bytes.data() + done, part);
    commands_.begin();
    commands_.copy(staging(), 0, to, offset + done, part);
    commands_.barrier();
    commands_.run();
  }
}

void Transfer::download(const Buffer& from, std::span<std::byte> bytes, std::size_t offset) {
  if (bytes.empty()) return;
  if (reaches(from)) {
    std::memcpy(bytes.data(), static_cast<const std::byte*>(from.mapped()) + offset, bytes.size());
    return;
  }
  for (std::size_t done = 0; done < bytes.size(); done += kStagingBytes) {
    const std::size_t part = std::min(kStagingBytes, bytes.size() - done);
    commands_.begin();
    commands_.copy(from, offset + done, staging(), 0, part);
    commands_.run();
    std::memcpy(bytes.data() + done, staging().mapped(), part);
  }
}

}  // namespace palpate::gpu
