// SPDX-License-Identifier: Apache-2.0
// engine/gpu/commands.hpp: a list of dispatches and copies that is recorded, submitted and waited for. Reusable:
// begin() waits for the last run and starts a new recording. Buffers and kernels of a recording must live until its run
// has ended.
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

// Numbers of work groups along x and y. Long lists are folded into rows, because a device may limit x to 65535.
struct Groups {
  std::uint32_t x = 1, y = 1;
  // `count` groups in rows of `row`. The kernel computes its index y * row + x and compares it with the count.
  static Groups folded(std::uint32_t count, std::uint32_t row);
};

class Commands {
 public:
  // `max_dispatches`: the most in one recording; as many descriptor sets are allocated.
  Commands(Gpu& gpu, std::string name, std::uint32_t max_dispatches);
  ~Commands();
  Commands(Commands&&) noexcept;
  Commands& operator=(Commands&&) noexcept;

  void begin();  // waits for the last run and forgets its recording
  // Binds buffers[i] to binding i, writes the push constants and dispatches. `buffers` must fill every binding of the
  // kernel: lavapipe 22.3 crashes on a binding that was never written.
  void dispatch(const Kernel& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> push,
                Groups groups);
  void copy(const Buffer& from, std::size_t from_offset, const Buffer& to, std::size_t to_offset, std::size_t bytes);
  void barrier();      // later kernels and copies see what earlier ones wrote
  void hostBarrier();  // after wait(), the host sees what earlier kernels and copies wrote
  // Times stages of the recorded work by the device's clock. mark() ends a stage, which began at the mark before it or
  // at begin(). Nothing is timed unless timed(true) was called before begin() and the device has such a clock.
  void timed(bool on);
  void mark(std::string name);
  [[nodiscard]] std::vector<StageTime> marks() const;  // of the last run, after wait()
  void submit();
  [[nodiscard]] bool done() const;  // the newest submission has ended; throws Error(kDevice)
  void wait();                      // for the newest submission; throws Error(kDevice) after 60 s
  void run();                       // hostBarrier, submit, wait

  struct State;

 private:
  std::unique_ptr<State> state_;
};

template <typename Push>
std::span<const std::byte> pushBytes(const Push& push) {
  return std::as_bytes(std::span<const Push>(&push, 1));
}

}  // namespace palpate::gpu
