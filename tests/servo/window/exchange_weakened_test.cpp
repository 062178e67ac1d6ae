// SPDX-License-Identifier: Apache-2.0
// Proof that the race test can fail: the same body on the same buffer with relaxed order (see CMakeLists.txt).
#include <gtest/gtest.h>

#include "exchange_race.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {
namespace exchange_weakened_test {

TEST(WeakenedTripleBuffer, IsReportedByTheThreadSanitizer) {
  TripleBuffer<Payload, std::memory_order_relaxed> buffer;
  const RaceOutcome outcome = race(buffer, 20000);
  EXPECT_EQ(outcome.torn, 0u);
}

}  // namespace exchange_weakened_test
}  // namespace palpate
