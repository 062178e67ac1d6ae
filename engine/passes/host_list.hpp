// SPDX-License-Identifier: Apache-2.0
// engine/passes/host_list.hpp: a list that the host fills and kernels read (or the other way round): it keeps a mapped
// buffer that grows when it must. Thread: the Gpu's; not while submitted work uses the buffer.
#pragma once

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "engine/gpu/buffer.hpp"

namespace palpate {

template <typename Item>
class HostList {
  static_assert(std::is_trivially_copyable_v<Item>);

 public:
  HostList(gpu::Gpu& gpu, std::string name, std::size_t capacity) : gpu_(gpu), name_(std::move(name)) { fit(capacity); }

  // Makes the buffer large enough for `count` items. Throws Error(kOutOfMemory); then the old buffer stays.
  void fit(std::size_t count) {
    if (buffer_ && count * sizeof(Item) <= buffer_->bytes()) return;
    const std::size_t wanted = std::max<std::size_t>(buffer_ ? 2 * buffer_->bytes() : 0, count * sizeof(Item));
    buffer_ = gpu::Buffer(gpu_, name_, std::max<std::size_t>(wanted, sizeof(Item)), gpu::MemoryKind::kHost);
  }
  void write(std::span<const Item> items) {
    fit(items.size());
    if (!items.empty()) std::memcpy(buffer_->mapped(), items.data(), items.size_bytes());
  }
  [[nodiscard]] std::span<const Item> read(std::size_t count) const {
    return {static_cast<const Item*>(buffer_->mapped()), count};
  }
  [[nodiscard]] const gpu::Buffer& buffer() const noexcept { return *buffer_; }

 private:
  gpu::Gpu& gpu_;
  std::string name_;
  std::optional<gpu::Buffer> buffer_;
};

}  // namespace palpate
