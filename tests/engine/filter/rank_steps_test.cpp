// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/rank_steps.hpp"

#include <algorithm>
#include <bit>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace rank_steps_test {

using ::testing::HasSubstr;

std::vector<FilterStep> steps(const char* chain, const Vec3& spacing_m = Vec3::Constant(1e-3)) {
  return lowerFilters(filterChain(chain), spacing_m);
}

std::set<std::tuple<int, int, int>> offsetsOf(const FilterStep& step) {
  std::set<std::tuple<int, int, int>> offsets;
  for (const ShapeRow& row : step.rows) {
    for (int di = -row.half; di <= row.half; ++di) offsets.emplace(di, row.dj, row.dk);
  }
  return offsets;
}

// Voxels whose centre is at most the radius away, and no others.
TEST(RankSteps, MedianReachesWholeVoxels) {
  EXPECT_EQ(steps("median:1")[0].reach, Vec3i(1, 1, 1));
  EXPECT_EQ(steps("median:1.9")[0].reach, Vec3i(1, 1, 1));
  EXPECT_EQ(steps("median:1mm", {0.5e-3, 0.7e-3, 1.3e-3})[0].reach, Vec3i(2, 1, 0));
  // 0.3 mm / 0.1 mm is less than 3 in binary, but is meant to be 3.
  EXPECT_EQ(steps("median:0.3mm", {0.1e-3, 0.3e-3, 0.6e-3})[0].reach, Vec3i(3, 1, 0));
  EXPECT_EQ(steps("median:1:border=mirror")[0].border, Border::kMirror);
}

TEST(RankSteps, AWindowOfOneVoxelGivesNoStep) {
  EXPECT_TRUE(steps("median:0.5").empty());
  EXPECT_TRUE(steps("close:0.9mm").empty());
  EXPECT_TRUE(steps("open:0.9:shape=ball").empty());
}

TEST(RankSteps, ABoxIsALineAlongEachAxis) {
  const auto lines = steps("dilate:2mm", {0.5e-3, 5e-3, 2e-3});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].kind, StepKind::kHighestOnLine);
  EXPECT_EQ(lines[0].axis, 0);
  EXPECT_EQ(lines[0].reach, Vec3i(4, 0, 0));
  EXPECT_EQ(lines[1].axis, 2);
  EXPECT_EQ(lines[1].reach, Vec3i(0, 0, 1));
}

TEST(RankSteps, OpeningErodesFirst) {
  const auto opened = steps("open:1:shape=ball"), closed = steps("close:1:shape=ball");
  ASSERT_EQ(opened.size(), 2U);
  EXPECT_EQ(opened[0].kind, StepKind::kLowestInRows);
  EXPECT_EQ(opened[1].kind, StepKind::kHighestInRows);
  ASSERT_EQ(closed.size(), 2U);
  EXPECT_EQ(closed[0].kind, StepKind::kHighestInRows);
  EXPECT_EQ(closed[1].kind, StepKind::kLowestInRows);
  // A step by its letter: the highest or the lowest, along which axis; balls are one step.
  const auto letters = [](const char* chain) {
    std::string text;
    for (const FilterStep& step : steps(chain)) {
      const bool highest = step.kind == StepKind::kHighestOnLine || step.kind == StepKind::kHighestInRows;
      const bool lowest = step.kind == StepKind::kLowestOnLine || step.kind == StepKind::kLowestInRows;
      text += highest ? 'H' : lowest ? 'L' : '?';
      text += step.rows.empty() ? "ijk"[step.axis] : 'o';
      EXPECT_EQ(step.border, Border::kNearest);
    }
    return text;
  };
  EXPECT_EQ(letters("dilate:1"), "HiHjHk");
  EXPECT_EQ(letters("erode:1"), "LiLjLk");
  EXPECT_EQ(letters("open:1:border=mirror"), "LiLjLkHiHjHk");
  EXPECT_EQ(letters("close:1:border=mirror"), "HiHjHkLiLjLk");
  EXPECT_EQ(letters("dilate:1:shape=ball"), "Ho");
  EXPECT_EQ(letters("erode:1:shape=ball"), "Lo");
}

TEST(RankSteps, ABallOfVoxels) {
  EXPECT_EQ(offsetsOf(steps("dilate:1:shape=ball")[0]).size(), 7U);     // the voxel and its six neighbours
  EXPECT_EQ(offsetsOf(steps("dilate:1.5:shape=ball")[0]).size(), 19U);  // those over edges too, at sqrt(2)
  EXPECT_EQ(offsetsOf(steps("dilate:2:shape=ball")[0]).size(), 33U);    // lattice points in a sphere (OEIS A000605)
  EXPECT_EQ(offsetsOf(steps("dilate:3:shape=ball")[0]).size(), 123U);
  EXPECT_EQ(offsetsOf(steps("dilate:4:shape=ball")[0]).size(), 257U);
}

// Round in metres where voxels are not cubes; in voxels it is as many along each axis.
TEST(RankSteps, ABallOfALengthIsRound) {
  const Vec3 spacing_m(0.7e-3, 0.9e-3, 1.3e-3);
  const FilterStep step = steps("erode:2.5mm:shape=ball", spacing_m)[0];
  EXPECT_EQ(step.reach, Vec3i(3, 2, 1));
  std::set<std::tuple<int, int, int>> expected;
  for (int dk = -9; dk <= 9; ++dk) {
    for (int dj = -9; dj <= 9; ++dj) {
      for (int di = -9; di <= 9; ++di) {
        if (Vec3(di, dj, dk).cwiseProduct(spacing_m).norm() <= 2.5e-3) expected.emplace(di, dj, dk);
      }
    }
  }
  EXPECT_EQ(offsetsOf(step), expected);
  EXPECT_EQ(offsetsOf(steps("erode:2:shape=ball", spacing_m)[0]).size(), 33U);
}

TEST(RankSteps, RowsComeShortestFirst) {
  const FilterStep step = steps("dilate:5:shape=ball")[0];
  EXPECT_TRUE(std::is_sorted(step.rows.begin(), step.rows.end(),
                             [](const ShapeRow& a, const ShapeRow& b) { return a.half < b.half; }));
}

struct TooFar {
  const char* fits;
  const char* refused;
  const char* says;
};
class RefusedReach : public testing::TestWithParam<TooFar> {};

TEST_P(RefusedReach, SaysHowFarIsPossible) {
  EXPECT_NO_THROW((void)steps(GetParam().fits));
  try {
    (void)steps(GetParam().refused);
    FAIL() << GetParam().refused;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().says));
    EXPECT_THAT(error.what(), HasSubstr("make it smaller"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Windows, RefusedReach,
    testing::Values(
        TooFar{"median:3.9", "median:4", "median of radius 4: along axis i it reaches 4 voxels; 3 are possible"},
        TooFar{"median:3mm", "median:1m", "median of radius 1 m: along axis i it reaches 1000 voxels; 3 are possible"},
        TooFar{"close:32", "close:33", "box of radius 33: along axis i it reaches 33 voxels; 32 are possible"},
        TooFar{"open:16:shape=ball", "open:17:shape=ball",
               "ball of radius 17: along axis i it reaches 17 voxels; 16 are possible"}));

// One of the values that are there: its own bits.
TEST(RankSteps, KeepAConstantAsItIs) {
  for (const char* chain : {"median:1", "dilate:1", "erode:1:shape=ball"}) {
    for (const float density : {0.0F, -0.0F, 1e30F, -1e-45F, 4095.0F}) {
      for (const FilterStep& step : steps(chain)) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(uniformResult(step, density)), std::bit_cast<std::uint32_t>(density));
      }
    }
  }
}

}  // namespace rank_steps_test
}  // namespace palpate
