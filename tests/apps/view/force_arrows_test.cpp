// SPDX-License-Identifier: Apache-2.0
#include "apps/view/force_arrows.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace palpate {
namespace force_arrows_test {

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

// In the middle of each 2 mm, 20 ticks, but for the fourth, where the largest force is clearly above the middle's. In
// the third it is above it by less than a twentieth.
TEST(ForceArrows, StandInTheMiddleOrAtThePeak) {
  std::vector<TickRecord> records = slide();
  records[45].force_W[2] = 0.52;
  for (std::size_t i = 0; i < records.size(); ++i) records[i].hip_W[1] = static_cast<double>(i);
  const ForceArrows forces = chooseForceArrows(records, 14);
  const std::vector<std::size_t> ticks = {10, 30, 50, 77, 90, 110, 130, 150, 170, 190};
  ASSERT_GE(forces.arrows.size(), ticks.size());
  for (std::size_t n = 0; n < ticks.size(); ++n) {
    const TickRecord& r = records[ticks[n]];
    EXPECT_EQ(forces.arrows[n].hip_W, asVec3(r.hip_W)) << n;
    EXPECT_EQ(forces.arrows[n].vhip_W, asVec3(r.vhip_W)) << n;
    EXPECT_EQ(forces.arrows[n].force_W, asVec3(r.force_W)) << n;
  }
}

// Three of four, or of five, are between a half and one and a half of the distance that is said.
TEST(ForceArrows, MostOfThemMustBeAsFarApartAsIsSaid) {
  ForceArrows forces;
  forces.every_m = 2;
  for (const double x_m : {0, 1, 4, 6, 11}) forces.arrows.push_back({Vec3::Zero(), Vec3(x_m, 0, 0), Vec3::Zero()});
  EXPECT_EQ(arrowWords(forces), "an arrow every 2000 mm");
  forces.arrows.push_back({Vec3::Zero(), Vec3(16, 0, 0), Vec3::Zero()});
  EXPECT_EQ(arrowWords(forces), "6 arrows along the way");
  forces.arrows.resize(2);
  EXPECT_EQ(arrowWords(forces), "an arrow every 2000 mm");
}

TEST(ForceColor, GoesFromYellowOverOrangeAndRedToViolet) {
  const auto expectColor = [](double share, double red, double green, double blue) {
    const Color color = forceColor(share);
    EXPECT_NEAR(color.red, red, 1e-12) << share;
    EXPECT_NEAR(color.green, green, 1e-12) << share;
    EXPECT_NEAR(color.blue, blue, 1e-12) << share;
  };
  expectColor(-1, 0.98, 0.75, 0.18);
  expectColor(1.0 / 6, 0.96, 0.585, 0.14);
  expectColor(0.5, 0.87, 0.265, 0.16);
  expectColor(5.0 / 6, 0.61, 0.08, 0.335);
  expectColor(2, 0.42, 0.05, 0.45);
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

TEST(ForceArrows, AreToldAsTheyStand) {
  EXPECT_EQ(arrowWords(chooseForceArrows(slide(), 14)), "an arrow every 2 mm");
  std::vector<TickRecord> tap(5);
  for (TickRecord& r : tap) r.in_contact = true;
  EXPECT_EQ(arrowWords(chooseForceArrows(tap, 14)), "the arrow");
}

// Taps 2 mm apart, each of some micrometres on the surface: the way in contact is short, the arrows are not.
TEST(ForceArrows, OfTapsAreNotEveryFewMicrometres) {
  std::vector<TickRecord> records;
  for (int tap = 0; tap < 12; ++tap) {
    for (int i = 0; i < 10; ++i) {
      TickRecord r;
      r.in_contact = i > 2;
      r.vhip_W[0] = 2e-3 * tap + 2e-6 * i;
      r.force_W[2] = r.in_contact ? 1 : 0;
      records.push_back(r);
    }
  }
  const ForceArrows forces = chooseForceArrows(records, 14);
  EXPECT_EQ(arrowWords(forces), fmt::format("{} arrows along the way", forces.arrows.size()));
}

// Ways of every size and shape: what the words say is what the arrows do. Half of the distance between neighbours is
// given to arrows that stand at a peak, and a quarter of them to bends and gaps.
TEST(ForceArrows, WordsHoldForEveryWay) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const double step_m = std::pow(10.0, std::uniform_real_distribution<double>(-9, -2)(random));
    std::vector<TickRecord> records(1 + random() % 400);
    Vec3 at = Vec3::Zero();
    for (TickRecord& r : records) {
      r.in_contact = random() % 50 != 0;
      at += step_m * Vec3(1, std::uniform_real_distribution<double>(-1, 1)(random), 0);
      if (trial % 3 == 0 && random() % 30 == 0) at += 100 * step_m * Vec3::UnitZ();
      Eigen::Map<Vec3>(r.vhip_W) = at;
      r.force_W[2] = std::uniform_real_distribution<double>(0, 2)(random);
    }
    const ForceArrows forces = chooseForceArrows(records, 14);
    const std::string words = arrowWords(forces);
    if (!words.starts_with("an arrow every ")) continue;
    const double said_m = std::stod(words.substr(15)) * 1e-3;
    std::vector<double> apart_m;
    for (std::size_t i = 1; i < forces.arrows.size(); ++i)
      apart_m.push_back((forces.arrows[i].vhip_W - forces.arrows[i - 1].vhip_W).norm());
    std::sort(apart_m.begin(), apart_m.end());
    const double median_m = apart_m[apart_m.size() / 2];
    EXPECT_GT(median_m, 0.5 * said_m * (1 - 1e-9)) << trial;
    EXPECT_LT(median_m, 1.5 * said_m * (1 + 1e-9)) << trial;
  }
}

TEST(RoundDown, GivesOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(roundDown(0.0199), 0.01);
  EXPECT_DOUBLE_EQ(roundDown(0.02), 0.02);
  EXPECT_DOUBLE_EQ(roundDown(7.3), 5);
  EXPECT_DOUBLE_EQ(roundDown(10), 10);
}

}  // namespace force_arrows_test
}  // namespace palpate
