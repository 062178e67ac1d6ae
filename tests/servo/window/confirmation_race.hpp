// SPDX-License-Identifier: Apache-2.0
// tests/servo/window/confirmation_race.hpp: one writer that writes a plain word and then confirms it, one reader that
// sees a confirmation and then reads the word.
//
// The words are plain memory, each written once. So only the confirmation orders the writing before the reading.
#pragma once

#include <cstdint>
#include <thread>
#include <vector>

namespace palpate {

struct ConfirmationOutcome {
  std::int64_t unwritten = 0;  // words that were confirmed but not written
  std::int64_t seen = 0;       // confirmations that differed from the one before
};

template <class Confirmed>
ConfirmationOutcome confirmationRace(Confirmed& confirmation, std::int64_t count) {
  std::vector<std::int64_t> words(static_cast<std::size_t>(count) + 1);
  ConfirmationOutcome outcome;
  std::thread writer([&] {
    for (std::int64_t n = 1; n <= count; ++n) {
      words[static_cast<std::size_t>(n)] = n;
      confirmation.confirm(n);
    }
  });
  for (std::int64_t last = 0; last < count;) {
    const std::int64_t now = confirmation.at_ns();
    if (words[static_cast<std::size_t>(now)] != now) ++outcome.unwritten;
    if (now != last) ++outcome.seen;
    last = now;
  }
  writer.join();
  return outcome;
}

}  // namespace palpate
