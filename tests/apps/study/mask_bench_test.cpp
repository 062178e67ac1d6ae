// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mask_bench.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/bench/result_file.hpp"
#include "apps/console/progress.hpp"
#include "apps/study/mask_shapes.hpp"
#include "base/whole_file.hpp"
#include "engine/field/few_values.hpp"

namespace palpate {
namespace mask_bench_test {

BenchResult measured(const char* shape, const std::vector<MaskWay>& ways) {
  Progress silent(nullptr);
  return runMaskBench({.shapes = {shape}, .ways = ways, .ticks = 1500}, silent);
}

double figure(const BenchResult& result, const char* way, const char* key) {
  const BenchRows rows = rowsOf(result, "mask", {{"way", way}});
  return rows.size() == 1 ? figureOf(*rows[0], key) : std::nan("");
}

TEST(MaskBench, ItsShapesAreMasks) {
  std::set<std::string> names;
  for (const MaskShape& shape : maskShapes()) {
    EXPECT_TRUE(names.insert(shape.name).second);
    const auto found = fewValuesOf(makeVolume(*makeMask(shape, 1)), kMaskIsovalue);
    ASSERT_TRUE(found) << shape.name;
    EXPECT_THAT(found->values, testing::ElementsAre(0, 1)) << shape.name;
  }
  for (const std::string& name : MaskBenchRequest::quick().shapes) EXPECT_EQ(names.count(name), 1U) << name;
}

// The stairs are there, a Gaussian removes them as far as the page says, and it moves the surface of a ball inward by
// sigma^2 / R: of which its kernel, which ends at three sigmas, has 97 to 99 %, and (sigma / R)^2 more is the next
// term. Places of the surface differ by some 0.15 voxel; their mean over 2000 is known to 0.02.
TEST(MaskBench, AGaussianSmoothsStairsAndMovesTheSurface) {
  const BenchResult result = measured("ball of 20 voxels", {{}, {.chain = "gaussian:1.5"}, {.chain = "gaussian:3"}});
  EXPECT_GT(figure(result, "none", "force_angle_median_deg"), 6);
  EXPECT_GT(figure(result, "none", "force_angle_p99_deg"), 15);
  ASSERT_EQ(result.targets.size(), 2U);  // median and p99, with the page's bounds
  EXPECT_TRUE(result.allHold());
  const double radius_voxel = 0.35 * 57, before = figure(result, "none", "surface_off_mean_voxel");
  for (const double sigma : {1.5, 3.0}) {
    const std::string way = fmt::format("gaussian:{:g}", sigma);
    EXPECT_NEAR(figure(result, way.c_str(), "surface_off_mean_voxel") - before, -sigma * sigma / radius_voxel, 0.03);
    EXPECT_EQ(figure(result, way.c_str(), "surface_lost_percent"), 0);
  }
  EXPECT_LT(figure(result, "gaussian:1.5", "force_jump_max_N"), 0.5 * figure(result, "none", "force_jump_max_N"));
}

// A median of a mask is a mask, and so is what opening and closing leave.
TEST(MaskBench, RanksLeaveStairs) {
  const BenchResult result =
      measured("ball of 20 voxels", {{}, {.chain = "median:2"}, {.chain = "open:1:shape=ball close:1:shape=ball"}});
  for (const BenchRow* row : rowsOf(result, "mask"))
    EXPECT_GT(figureOf(*row, "force_angle_median_deg"), 6) << textOf(*row, "way");
}

// Smoothed normals leave surface and volume as they are.
TEST(MaskBench, SmoothNormalsMoveNothing) {
  const BenchResult result = measured("ball of 20 voxels", {{}, {.gradient = "gaussian:1.5"}});
  const char* const smooth = "normals of gaussian:1.5";
  EXPECT_EQ(figure(result, smooth, "surface_off_mean_voxel"), figure(result, "none", "surface_off_mean_voxel"));
  EXPECT_EQ(figure(result, smooth, "volume_change_percent"), 0);
  EXPECT_LT(figure(result, smooth, "force_angle_median_deg"), 2);
  EXPECT_LT(figure(result, smooth, "force_angle_p99_deg"), 7);
}

// Half of a wall of w voxels is above one half, in its middle, as long as erf(w / (2 sqrt(2) sigma)) is: to
// w = 1.349 sigma. The wall of 2.5 bears a sigma of 1.85. Where lattice and wall lie so that the mask is a voxel
// thicker, a crumb stays.
TEST(MaskBench, AWallVanishesWhereTheFilterIsTooWide) {
  const BenchResult result = measured("wall of 2.5 voxels", {{.chain = "gaussian:1.5"}, {.chain = "gaussian:2"}});
  EXPECT_EQ(figure(result, "gaussian:1.5", "surface_lost_percent"), 0);
  EXPECT_GT(figure(result, "gaussian:2", "surface_lost_percent"), 99);
  EXPECT_EQ(figure(result, "gaussian:2", "in_contact_percent"), 0);
}

// A sigma in voxels is as long as a stair along each axis.
TEST(MaskBench, ThickSlicesAreSmoothedInVoxels) {
  const BenchResult result = measured("ball of 20 mm, slices of 3 mm", {{}, {.chain = "gaussian:1.5"}});
  EXPECT_LT(figure(result, "gaussian:1.5", "force_angle_p99_deg"), 0.5 * figure(result, "none", "force_angle_p99_deg"));
  EXPECT_TRUE(result.allHold());
}

// docs/masks.md has the figures of docs/results/masks.json, those of the choices that it compares.
TEST(MaskBench, ThePageHasItsFigures) {
  const BenchResult result = readBenchResult(PALPATE_DOCS "/results/masks.json");
  const char* const kShapes[] = {"ball of 10 voxels", "ball of 20 voxels", "tube of 6 voxels", "wall of 2.5 voxels",
                                 "ball of 20 mm, slices of 3 mm"};
  std::string table = "| way |";
  for (const char* shape : kShapes) table += fmt::format(" {} |", shape);
  table += "\n|---|---|---|---|---|---|\n";
  for (const MaskWay& way : maskWays()) {
    table += fmt::format("| {} |", way.words());
    for (const char* shape : kShapes) {
      const BenchRows rows = rowsOf(result, "mask", {{"shape", shape}, {"way", way.words()}});
      ASSERT_EQ(rows.size(), 1U) << shape << ", " << way.words();
      const auto median = numberIn(*rows[0], "force_angle_median_deg");
      const auto p99 = numberIn(*rows[0], "force_angle_p99_deg");
      table += median && p99 ? fmt::format(" {:.1f} / {:.0f} deg, {:.0f} % |", *median, *p99,
                                           std::round(figureOf(*rows[0], "volume_change_percent")) + 0.0)
                             : std::string(" gone |");
    }
    table += "\n";
  }
  EXPECT_NE(wholeFile(PALPATE_DOCS "/masks.md", "the page", 1U << 20U).find(table), std::string::npos)
      << "docs/masks.md must hold:\n"
      << table;
}

}  // namespace mask_bench_test
}  // namespace palpate
