// SPDX-License-Identifier: Apache-2.0
// base/shared_buffer.hpp: memory that a child process (base/child_process.hpp) fills for its parent. It begins as
// zeros. The constructor throws std::bad_alloc. Any thread.
#pragma once

#include <cstddef>
#include <new>
#include <span>

#include <sys/mman.h>

namespace palpate {

class SharedBuffer {
 public:
  explicit SharedBuffer(std::size_t bytes) : bytes_(bytes) {
    if (bytes_ == 0) return;
    memory_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~SharedBuffer() {
    if (bytes_ > 0) munmap(memory_, bytes_);
  }
  SharedBuffer(const SharedBuffer&) = delete;
  SharedBuffer& operator=(const SharedBuffer&) = delete;

  [[nodiscard]] std::span<char> bytes() const noexcept { return {static_cast<char*>(memory_), bytes_}; }

 private:
  std::size_t bytes_;
  void* memory_ = nullptr;
};

}  // namespace palpate
