// SPDX-License-Identifier: Apache-2.0
// service/memory/sealed_memory.hpp: memory that two processes share and whose size neither can change any more.
//
// A process that maps a file which another one then shortens is killed at its next look. So the one that makes the
// memory seals its size (memfd_create(2), F_ADD_SEALS), and the one that is given it maps nothing else. Any thread;
// system calls. Linux only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/descriptor.hpp"

namespace palpate {

class SealedMemory {
 public:
  static constexpr std::size_t kPage = 4096;
  [[nodiscard]] static constexpr std::size_t wholePages(std::size_t bytes) {
    return (bytes + kPage - 1) / kPage * kPage;
  }

  // When the system gives it: before the first use, which then takes no time for it, or page by page, if most of it may
  // never be used.
  enum class Pages : std::uint8_t { kAtOnce, kWhenUsed };

  SealedMemory() = default;
  // Zeros. `name`: for /proc/PID/maps. Throws Error(kOutOfMemory).
  SealedMemory(const char* name, std::size_t bytes, Pages pages = Pages::kAtOnce);
  // That of another process. Throws Error(kBadInput) for a descriptor of anything else, or if it has not `bytes` bytes.
  SealedMemory(Descriptor given, std::size_t bytes, Pages pages = Pages::kAtOnce);
  ~SealedMemory();
  SealedMemory(SealedMemory&& other) noexcept;
  SealedMemory& operator=(SealedMemory&& other) noexcept;

  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] int descriptor() const noexcept { return file_.get(); }  // to be sent; stays this object's

 private:
  void map(Pages pages);

  Descriptor file_;
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace palpate
