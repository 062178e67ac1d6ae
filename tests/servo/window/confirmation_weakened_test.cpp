// SPDX-License-Identifier: Apache-2.0
// Proof that the confirmation's test can fail: the same body with one side relaxed, or both (see CMakeLists.txt). Each
// of them must be reported, so each is an entry of its own.
#include <gtest/gtest.h>

#include "confirmation_race.hpp"
#include "servo/window/confirmation.hpp"

namespace palpate {
namespace confirmation_weakened_test {

template <class Confirmed>
void raceOf() {
  Confirmed confirmation;
  EXPECT_EQ(confirmationRace(confirmation, 20000).unwritten, 0);
}

TEST(WeakenedConfirmation, StoreIsReportedByTheThreadSanitizer) {
  raceOf<Confirmation<std::memory_order_relaxed, std::memory_order_acquire>>();
}

TEST(WeakenedConfirmation, LoadIsReportedByTheThreadSanitizer) {
  raceOf<Confirmation<std::memory_order_release, std::memory_order_relaxed>>();
}

}  // namespace confirmation_weakened_test
}  // namespace palpate
