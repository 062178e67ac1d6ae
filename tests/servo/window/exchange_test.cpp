// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "confirmation_race.hpp"
#include "exchange_race.hpp"
#include "servo/window/confirmation.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/triple_buffer.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace exchange_test {

#ifdef __SANITIZE_THREAD__
constexpr std::uint64_t kPublications = 200'000;
#else
constexpr std::uint64_t kPublications = 3'000'000;
#endif

TEST(TripleBuffer, NothingTornOrBackwardBetweenTwoThreads) {
  TripleBuffer<Payload> buffer;
  const RaceOutcome outcome = race(buffer, kPublications);
  EXPECT_EQ(outcome.torn, 0u);
  EXPECT_EQ(outcome.backward, 0u);
  EXPECT_EQ(outcome.last, kPublications);
  EXPECT_GT(outcome.seen, 1u);  // the two did run side by side
}

// Again until the two have run side by side: on a busy machine one may be done before the other begins.
TEST(Confirmation, WhatWasWrittenBeforeItIsThere) {
  std::int64_t seen = 0;
  for (int i = 0; i < 1000 && seen <= 1; ++i) {
    Confirmation<> confirmation;
    EXPECT_EQ(confirmation.at_ns(), 0);
    const ConfirmationOutcome outcome = confirmationRace(confirmation, static_cast<std::int64_t>(kPublications));
    EXPECT_EQ(outcome.unwritten, 0);
    seen = outcome.seen;
  }
  EXPECT_GT(seen, 1);
}

TEST(TripleBuffer, LatestWinsAndStaysUntilTheNextCall) {
  TripleBuffer<int> buffer(-1);
  EXPECT_EQ(buffer.latest(), -1);
  buffer.back() = 1;
  buffer.publish();
  const int& held = buffer.latest();
  EXPECT_EQ(held, 1);
  for (int i = 2; i < 10; ++i) {
    buffer.back() = i;
    buffer.publish();
  }
  EXPECT_EQ(held, 1);
  EXPECT_EQ(buffer.latest(), 9);
  EXPECT_EQ(buffer.latest(), 9);
}

void fillBack(WindowExchange& exchange, int side, float value, std::int64_t stamp_ns) {
  SampleWindow& window = exchange.back();
  window.size = Vec3i::Constant(side);
  window.stamp_ns = stamp_ns;
  std::fill_n(exchange.backSamples(), side * side * side, Sample{value, value, value, value});
}

TEST(WindowExchange, NothingIsUsableBeforeTheFirstPublication) {
  WindowStorage storage(8);
  WindowExchange exchange(storage);
  EXPECT_FALSE(exchange.latest().usable());
  EXPECT_EQ(exchange.latest().version, 0u);
}

TEST(WindowExchange, CountsVersionsAndKeepsEachSlotsSamples) {
  WindowStorage storage(27);
  WindowExchange exchange(storage);
  for (int i = 1; i <= 7; ++i) {
    EXPECT_EQ(exchange.nextVersion(), static_cast<std::uint64_t>(i));
    fillBack(exchange, 3, static_cast<float>(i), std::int64_t{10} * i);
    exchange.back().samples = nullptr;  // a writer that copies a whole window over it does no harm
    exchange.publish();
    const SampleWindow& window = exchange.latest();
    ASSERT_TRUE(window.usable());
    EXPECT_EQ(window.version, static_cast<std::uint64_t>(i));
    EXPECT_EQ(window.samples[26].density, static_cast<float>(i));
    EXPECT_EQ(exchange.confirmedAt_ns(), 10 * i);
  }
  exchange.confirm(1000);
  EXPECT_EQ(exchange.confirmedAt_ns(), 1000);
}

TEST(WindowExchange, RefusesWhatDoesNotFit) {
  WindowStorage storage(26);
  WindowExchange exchange(storage);
  exchange.back().size = Vec3i::Constant(3);
  EXPECT_THROW(exchange.publish(), Error);
  exchange.back().size = Vec3i(1, 3, 3);
  EXPECT_THROW(exchange.publish(), Error);
  EXPECT_FALSE(exchange.latest().usable());
  Sample one[8];
  EXPECT_THROW(WindowExchange({one, one, one}, 8), Error);
  EXPECT_THROW(WindowExchange({one, nullptr, one}, 8), Error);
}

// Three of their own, of eight samples or more, whichever is missing or shared; the least window is one cell.
TEST(WindowExchange, TakesThreeStoragesOfACellOrMore) {
  Sample a[8], b[8], c[8];
  using Storages = std::array<Sample*, 3>;
  for (const Storages& bad : {Storages{a, a, b}, Storages{a, b, a}, Storages{b, a, a}, Storages{nullptr, a, b},
                              Storages{a, nullptr, b}, Storages{a, b, nullptr}})
    EXPECT_THROW(WindowExchange(bad, 8), Error);
  EXPECT_THROW(WindowExchange({a, b, c}, 7), Error);
  WindowExchange exchange({a, b, c}, 8);
  fillBack(exchange, 2, 1, 10);
  exchange.publish();
  EXPECT_TRUE(exchange.latest().usable());
}

// Windows of 8 x 8 x 8 samples that all carry their version; the servo must never see a mix, and a window confirmed at
// a time must be at least as new as the one that was published before that confirmation.
TEST(WindowExchange, ServoSeesWholeWindowsAndAtLeastTheConfirmedOne) {
  constexpr int kSide = 8;
  const auto publications = static_cast<std::int64_t>(kPublications / 30);
  WindowStorage storage(std::size_t{kSide} * kSide * kSide);
  WindowExchange exchange(storage);
  std::atomic<bool> done{false};
  std::thread engine([&] {
    for (std::int64_t n = 1; n <= publications; ++n) {
      fillBack(exchange, kSide, static_cast<float>(n), n);
      exchange.publish();
    }
    done.store(true, std::memory_order_release);
  });
  std::int64_t mixed = 0, older = 0;
  while (!done.load(std::memory_order_acquire)) {
    const std::int64_t confirmed = exchange.confirmedAt_ns();
    const SampleWindow& window = exchange.latest();
    if (static_cast<std::int64_t>(window.version) < confirmed) ++older;
    if (!window.usable()) continue;
    const auto expected = static_cast<float>(window.version);
    for (int i = 0; i < kSide * kSide * kSide; ++i) mixed += window.samples[i].density == expected ? 0 : 1;
  }
  engine.join();
  EXPECT_EQ(mixed, 0);
  EXPECT_EQ(older, 0);
  EXPECT_EQ(exchange.latest().version, static_cast<std::uint64_t>(publications));
}

}  // namespace exchange_test
}  // namespace palpate
