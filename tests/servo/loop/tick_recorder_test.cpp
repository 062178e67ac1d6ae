// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/tick_recorder.hpp"

#include <algorithm>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace tick_recorder_test {

// The ticks of what is kept of so many records, each spoiled after it was given.
std::vector<std::int64_t> ticksTaken(std::size_t capacity, std::int64_t count) {
  TickRecorder recorder(capacity);
  for (std::int64_t tick = 0; tick < count; ++tick) {
    TickRecord* record = recorder.next();
    EXPECT_EQ(record == nullptr, capacity == 0);
    if (record == nullptr) continue;
    // The padding too: runs are compared as bytes.
    const auto* bytes = reinterpret_cast<const unsigned char*>(record);
    EXPECT_TRUE(std::all_of(bytes, bytes + sizeof *record, [](unsigned char byte) { return byte == 0; })) << tick;
    std::memset(static_cast<void*>(record), 0xff, sizeof *record);
    record->tick = tick;
  }
  std::vector<std::int64_t> ticks;
  for (const TickRecord& record : recorder.taken()) ticks.push_back(record.tick);
  EXPECT_TRUE(recorder.taken().empty());
  return ticks;
}

TEST(TickRecorder, KeepsTheNewestInTheirOrder) {
  using testing::ElementsAre;
  EXPECT_THAT(ticksTaken(3, 0), testing::IsEmpty());
  EXPECT_THAT(ticksTaken(3, 2), ElementsAre(0, 1));
  EXPECT_THAT(ticksTaken(3, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(ticksTaken(3, 4), ElementsAre(1, 2, 3));
  EXPECT_THAT(ticksTaken(3, 8), ElementsAre(5, 6, 7));
  EXPECT_THAT(ticksTaken(0, 2), testing::IsEmpty());
}

}  // namespace tick_recorder_test
}  // namespace palpate
