// SPDX-License-Identifier: Apache-2.0
// engine/gpu/commands.hpp: a list of dispatches and copies that is recorded, submitted and waited for. Reusable: the
// next begin() starts it anew, after its last run has ended. Buffers and kernels named in it must live until then.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/measured.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/kernel.hpp"

namespace palpate::gpu {

// A list of work groups folded into rows, since a device may limit x to 65535.
struct Groups {
  std::uint32_t x = 1, y = 1;
  // `count` groups in rows of `row`; the kernel computes y * row + x and tests it against the count.
  static Groups folded(std::uint32_t count, std::uint32_t row);
};

class Commands {
 public:
  // `max_dispatches`: in one recording; descriptor sets are made for so many.
  Commands(Gpu& gpu, std::string name, std::uint32_t max_dispatches);
  ~Commands();
  Commands(Commands&&) noexcept;
  Commands& operator=(Commands&&) noexcept;

  void begin();  // waits for the last run, forgets its recording
  // Binds every buffer to its place (binding i = buffers[i]; all of them: a binding that was never written crashes
  // lavapipe 22.3), pushes `push` and dispatches.
  void dispatch(const Kernel& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> push,
                Groups groups);
  void copy(const Buffer& from, std::size_t from_offset, const Buffer& to, std::size_t to_offset, std::size_t bytes);
  void barrier();      // what was written before is seen by kernels and copies after
  void hostBarrier();  // what was written before is seen by the host after wait()
  // Times the recorded work on the device's own clock: mark() ends a stretch that began at the last mark, or at the
  // first call. Only where timed() was called before begin(), and where the device has such a clock.
  void timed(bool on);
  void mark(std::string name);
  [[nodiscard]] std::vector<StageTime> marks() const;  // of the last run, after wait()
  void submit();
  void wait();  // until the newest submission is done; throws Error(kDevice) after 60 s
  void run();   // hostBarrier, submit, wait

  struct State;

 private:
  std::unique_ptr<State> state_;
};

template <typename Push>
std::span<const std::byte> pushBytes(const Push& push) {
  return std::as_bytes(std::span<const Push>(&push, 1));
}

}  // namespace palpate::gpu
