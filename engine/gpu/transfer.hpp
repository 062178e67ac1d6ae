// SPDX-License-Identifier: Apache-2.0
// engine/gpu/transfer.hpp: copies bytes between the host and a buffer. A mapped buffer is copied in place, any other
// piece by piece through one staging buffer. Blocks until the bytes are there.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"

namespace palpate::gpu {

class Transfer {
 public:
  // `in_place` false: always uses the staging buffer, so that tests cover it on any device.
  explicit Transfer(Gpu& gpu, bool in_place = true);

  // Whether the host reads and writes this buffer in place.
  [[nodiscard]] bool reaches(const Buffer& buffer) const noexcept { return in_place_ && buffer.mapped() != nullptr; }

  void upload(std::span<const std::byte> bytes, const Buffer& to, std::size_t offset = 0);
  void download(const Buffer& from, std::span<std::byte> bytes, std::size_t offset = 0);

 private:
  Buffer& staging();

  Gpu& gpu_;
  bool in_place_;
  std::optional<Buffer> staging_;
  Commands commands_;
};

}  // namespace palpate::gpu
