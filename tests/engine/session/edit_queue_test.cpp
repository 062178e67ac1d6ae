// SPDX-License-Identifier: Apache-2.0
// The queue is tried with a taker that is slower than its givers, and with ends from both sides.
#include "engine/session/edit_queue.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace edit_queue_test {

using std::chrono::milliseconds;

// An order that carries a number.
EditOrder order(std::uint64_t number) {
  EditOrder made;
  made.text.command.value = static_cast<double>(number);
  return made;
}
std::uint64_t numberOf(const EditOrder& order) {
  return static_cast<std::uint64_t>(order.text.command.value);
}

// A taker that rests now and then until the queue is full: it is, at its capacity, and gets no fuller; every order
// arrives, once, in its place.
TEST(EditQueue, AMillionOrdersPassASlowTakerInOrder) {
  constexpr std::uint64_t kOrders = 1'000'000;
  constexpr std::size_t kCapacity = 256;
  EditQueue queue(kCapacity);
  std::atomic<std::uint64_t> given = 0;
  std::jthread giver([&] {
    for (; given < kOrders; ++given) {
      if (!queue.push(order(given))) return;
    }
    queue.close();
  });
  std::uint64_t taken = 0;
  while (const auto next = queue.pop()) {
    if (numberOf(*next) != taken) break;
    if (++taken % 100'000 != 1) continue;
    while (given < taken + kCapacity) std::this_thread::sleep_for(milliseconds(1));
    std::this_thread::sleep_for(milliseconds(5));  // in which the giver gives no more
    EXPECT_EQ(given, taken + kCapacity);
  }
  queue.abandon();  // lets the giver go if an order was out of place
  EXPECT_EQ(taken, kOrders);
}

// Each giver's own orders keep their order, whatever the others do.
TEST(EditQueue, SeveralGiversKeepTheirOrder) {
  constexpr std::uint64_t kEach = 20'000;
  constexpr std::uint64_t kGivers = 4;
  constexpr std::uint64_t kCapacity = 8;
  EditQueue queue(kCapacity);
  std::atomic<std::uint64_t> at_work = kGivers;
  std::atomic<std::uint64_t> given = 0;  // counted behind their push, so never more than there were
  std::uint64_t taken = 0;
  std::vector<std::jthread> givers;
  for (std::uint64_t giver = 0; giver < kGivers; ++giver) {
    givers.emplace_back([&, giver] {
      for (std::uint64_t i = 0; i < kEach; ++i) {
        if (!queue.push(order(giver * kEach + i))) return;
        ++given;
      }
      if (--at_work == 0) queue.close();
    });
  }
  std::array<std::uint64_t, kGivers> next{};
  while (const auto got = queue.pop()) {
    const std::uint64_t giver = numberOf(*got) / kEach;
    EXPECT_EQ(numberOf(*got) % kEach, next.at(giver)++);
    EXPECT_LE(given, ++taken + kCapacity);
  }
  for (const std::uint64_t count : next) EXPECT_EQ(count, kEach);
}

TEST(EditQueue, AGiverThatWaitsIsWokenWhenTheTakerGoes) {
  EditQueue queue(2);
  std::atomic<std::uint64_t> given = 0;
  std::jthread giver([&] {
    while (queue.push(order(given))) ++given;
  });
  while (given < 2) std::this_thread::sleep_for(milliseconds(1));
  std::this_thread::sleep_for(milliseconds(20));  // it waits now, or will at once: both must end
  queue.abandon();
  giver.join();
  EXPECT_EQ(given, 2U);
  EXPECT_TRUE(queue.abandoned());
  EXPECT_FALSE(queue.push(order(9)));
}

TEST(EditQueue, ATakerThatWaitsIsWokenByTheEnd) {
  EditQueue queue(2);
  std::jthread giver([&] {
    std::this_thread::sleep_for(milliseconds(20));
    queue.close();
  });
  EXPECT_FALSE(queue.pop());
  EXPECT_FALSE(queue.push(order(1)));  // closed is closed
}

// What was given before a giver failed is taken first; then its reason comes, as often as it is asked for.
TEST(EditQueue, AFailureArrivesBehindTheLastOrder) {
  EditQueue queue(4);
  ASSERT_TRUE(queue.push(order(1)));
  ASSERT_TRUE(queue.push(order(2)));
  queue.fail(std::make_exception_ptr(std::runtime_error("the pipe broke")));
  queue.close();  // takes nothing back
  EXPECT_EQ(numberOf(queue.pop().value()), 1U);
  EXPECT_EQ(numberOf(queue.pop().value()), 2U);
  EXPECT_THROW(static_cast<void>(queue.pop()), std::runtime_error);
  EXPECT_THROW(static_cast<void>(queue.pop()), std::runtime_error);
}

TEST(EditQueue, HoldsOneOrderAtLeast) {
  EditQueue queue(0);
  ASSERT_TRUE(queue.push(order(7)));
  EXPECT_EQ(numberOf(queue.pop().value()), 7U);
}

}  // namespace edit_queue_test
}  // namespace palpate
