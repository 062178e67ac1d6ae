// SPDX-License-Identifier: Apache-2.0
// engine/files/large_buffer.hpp: uninitialised memory for a file's values, on large pages if the system has them.
// Touching half a gigabyte for the first time in pages of 4 KiB takes as long as reading it. Private to engine/files.
// Throws std::bad_alloc. Any thread.
#pragma once

#include <cstdlib>
#include <memory>
#include <new>

#include <sys/mman.h>

namespace palpate {

class LargeBuffer {
 public:
  explicit LargeBuffer(std::size_t bytes) : bytes_(bytes) {
    constexpr std::size_t kPage = std::size_t{2} << 20;
    const std::size_t whole = (bytes + kPage - 1) / kPage * kPage;
    memory_.reset(static_cast<char*>(std::aligned_alloc(kPage, whole)));
    if (memory_ == nullptr) throw std::bad_alloc();
    madvise(memory_.get(), whole, MADV_HUGEPAGE);  // only a hint: it may fail
  }
  [[nodiscard]] char* data() noexcept { return memory_.get(); }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_; }

 private:
  struct Free {
    void operator()(char* memory) const noexcept { std::free(memory); }
  };
  std::unique_ptr<char, Free> memory_;
  std::size_t bytes_;
};

}  // namespace palpate
