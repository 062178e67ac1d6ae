// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/faults.hpp"

#include <bit>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace faults_test {

TEST(Faults, EveryRowIsOneBitInOrderWithTexts) {
  std::uint32_t seen = 0;
  for (const FaultText& row : faultTable()) {
    EXPECT_EQ(std::popcount(bit(row.fault)), 1);
    EXPECT_GT(bit(row.fault), seen) << row.name;
    seen |= bit(row.fault);
    EXPECT_STRNE(row.name, "");
    EXPECT_STRNE(row.text, "");
    EXPECT_STRNE(row.effect, "");
    EXPECT_STRNE(row.remedy, "");
  }
  EXPECT_EQ(seen & kFadingFaults, kFadingFaults);
  // A bit without a row would be a gap here.
  EXPECT_EQ(seen, (1U << faultTable().size()) - 1);
}

TEST(Faults, NamesOfSetBits) {
  EXPECT_EQ(faultNames(0), "none");
  EXPECT_EQ(faultNames(bit(ServoFault::kOverrun) | bit(ServoFault::kNoWindow)), "no-window overrun");
  EXPECT_EQ(faultNames(1U << 31), "unknown-fault");
}

TEST(Faults, OneLineForEachSetBitWithItsRemedy) {
  const std::string text = describeFaults(bit(ServoFault::kStaleWindow) | bit(ServoFault::kForceLimited));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, testing::HasSubstr("stale-window: "));
  EXPECT_THAT(text, testing::HasSubstr("; the force falls to zero within the fade time"));
  EXPECT_THAT(text, testing::HasSubstr("lower the stiffness"));
  EXPECT_EQ(describeFaults(0), "");
}

TEST(FaultDocument, IsTheCommittedPage) {
  std::ifstream in(PALPATE_DOCS "/faults.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_EQ(page, faultDocument()) << "run: palpate faults > docs/faults.md";
}

TEST(FaultDocument, HasARowForEachFault) {
  for (const FaultText& row : faultTable()) {
    EXPECT_THAT(faultDocument(), testing::HasSubstr(fmt::format("\n| `{}` | {} | {} | {} |", row.name, bit(row.fault),
                                                                row.text, row.effect)));
  }
}

}  // namespace faults_test
}  // namespace palpate
