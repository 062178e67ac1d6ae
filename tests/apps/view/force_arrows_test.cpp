// SPDX-License-Identifier: Apache-2.0
#include "apps/view/force_arrows.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

// A slide of 20 mm in 200 ticks with one peak of force.
std::vector<TickRecord> slide() {
  std::vector<TickRecord> records(201);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].in_contact = true;
    records[i].vhip_W[0] = 0.1e-3 * static_cast<double>(i);
    records[i].force_W[2] = i == 77 ? 3 : 0.5;
  }
  return records;
}

TEST(ForceArrows, AreSpreadOverTheWayAndKeepThePeak) {
  const ForceArrows forces = chooseForceArrows(slide(), 14);
  EXPECT_DOUBLE_EQ(forces.every_m, 2e-3);  // 20 mm / 14 * 1.5 = 2.1 mm
  EXPECT_GE(forces.arrows.size(), 10U);
  EXPECT_LE(forces.arrows.size(), 11U);
  EXPECT_EQ(forces.most_N, 3);
  int peaks = 0;
  for (const ForceArrow& arrow : forces.arrows) peaks += arrow.force_W.z() == 3;
  EXPECT_EQ(peaks, 1);
}

TEST(ForceArrows, WithoutContactThereAreNone) {
  EXPECT_TRUE(chooseForceArrows(std::vector<TickRecord>(10), 14).arrows.empty());
  EXPECT_EQ(chooseForceArrows({}, 14).most_N, 0);
}

TEST(ForceArrows, ATapHasOne) {
  std::vector<TickRecord> tap(5);
  for (TickRecord& r : tap) r.in_contact = true;
  tap[2].force_W[0] = 1;
  EXPECT_EQ(chooseForceArrows(tap, 14).arrows.size(), 1U);
}

TEST(RoundDown, GivesOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(roundDown(0.0199), 0.01);
  EXPECT_DOUBLE_EQ(roundDown(0.02), 0.02);
  EXPECT_DOUBLE_EQ(roundDown(7.3), 5);
  EXPECT_DOUBLE_EQ(roundDown(10), 10);
}

}  // namespace
}  // namespace palpate
