// SPDX-License-Identifier: Apache-2.0
// tests/servo/window/exchange_race.hpp: one writer and one reader at full speed over any triple buffer.
//
// The payload is long enough to tear. All its words hold the number of its publication. A torn payload has two numbers
// in it. One that goes backward has a smaller number than the payload before.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

namespace palpate {

struct Payload {
  std::array<std::uint64_t, 128> words{};  // 1 KiB: sixteen cache lines
};

struct RaceOutcome {
  std::uint64_t torn = 0, backward = 0, seen = 0, last = 0;
};

template <class Buffer>
RaceOutcome race(Buffer& buffer, std::uint64_t publications) {
  std::atomic<bool> done{false};
  RaceOutcome outcome;
  std::thread writer([&] {
    for (std::uint64_t n = 1; n <= publications; ++n) {
      buffer.back().words.fill(n);
      buffer.publish();
    }
    done.store(true, std::memory_order_release);
  });
  // The round after `done` sees the last publication: `done` is released after it.
  for (bool last_round = false; !last_round;) {
    last_round = done.load(std::memory_order_acquire);
    const auto& words = buffer.latest().words;
    const std::uint64_t number = words.front();
    if (std::any_of(words.begin(), words.end(), [&](std::uint64_t word) { return word != number; })) ++outcome.torn;
    if (number < outcome.last) ++outcome.backward;
    if (number != outcome.last) ++outcome.seen;
    outcome.last = number;
  }
  writer.join();
  return outcome;
}

}  // namespace palpate
