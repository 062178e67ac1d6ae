// SPDX-License-Identifier: Apache-2.0
// engine/passes/host_list.hpp: a list in a mapped buffer. The host writes it and kernels read it, or the other way
// round. The buffer grows when needed, by doubling, up to what one binding of the device may hold. Thread: the Gpu's;
// not while submitted work uses the buffer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

template <typename Item>
class HostList {
  static_assert(std::is_trivially_copyable_v<Item>);

 public:
  // `most_bytes`: limit of the list; 0: what the device allows in one binding.
  HostList(gpu::Gpu& gpu, std::string name, std::size_t capacity, std::uint64_t most_bytes = 0)
      : gpu_(gpu), name_(std::move(name)), most_bytes_(most_bytes != 0 ? most_bytes : gpu.info().max_binding_bytes) {
    fit(capacity);
  }

  // Makes the buffer large enough for `count` items. Throws Error(kOutOfMemory) and keeps the old buffer.
  void fit(std::size_t count) {
    const std::size_t needed = std::max<std::size_t>(count, 1) * sizeof(Item);
    if (buffer_ && needed <= buffer_->bytes()) return;
    if (needed > most_bytes_) {
      throw Error(Error::Code::kOutOfMemory, name_,
                  fmt::format("{} are needed, and the device allows {} at once; nothing was changed", inMiB(needed),
                              inMiB(most_bytes_)),
                  "use a smaller brush or stamp, or several edits");
    }
    const std::size_t doubled = buffer_ ? std::min<std::uint64_t>(2 * buffer_->bytes(), most_bytes_) : 0;
    buffer_ = gpu::Buffer(gpu_, name_, std::max(doubled, needed), gpu::MemoryKind::kHost);
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
  std::uint64_t most_bytes_;
  std::optional<gpu::Buffer> buffer_;
};

}  // namespace palpate
