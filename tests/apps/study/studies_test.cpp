// SPDX-License-Identifier: Apache-2.0
// Some cells of every study that needs a Vulkan device. What they find must show the order of convergence that theory
// gives, in every round the same; a library that is not installed must be left out, and say so.
#include <cmath>

#include <gmock/gmock.h>

#include "apps/study/cell_runner.hpp"
#include "apps/study/fitted_order.hpp"
#include "apps/study/study.hpp"

namespace palpate {
namespace studies_test {

using testing::HasSubstr;

struct Found {
  std::vector<BenchRow> rows;  // parameters and errors of cells that were measured
  std::vector<std::string> left_out;
};

// The quick cells whose parameters contain one of these.
Found foundBy(const char* study, const std::vector<BenchRow>& wanted) {
  StudySettings settings{.quick = true};
  settings.python = {"/nowhere/python"};
  const std::vector<StudyCell> cells = studyNamed(study).cells(settings);
  std::vector<const StudyCell*> some;
  for (const StudyCell& cell : cells) {
    const bool is_wanted =
        std::any_of(wanted.begin(), wanted.end(), [&](const BenchRow& one) { return hasAll(cell.parameters, one); });
    if (is_wanted) some.push_back(&cell);
  }
  const CellRuns runs = runCells(
      some, {.rounds = 1}, [] { return false; }, [](const RunState&) {});
  Found found;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const CellRun& run = runs.cells[i];
    EXPECT_TRUE(run.repeats) << cellKey(some[i]->parameters);
    if (!run.left_out.empty()) {
      found.left_out.push_back(run.left_out);
      continue;
    }
    for (const auto& [key, each] : run.costs) EXPECT_GT(each.at(0), 0) << key;
    BenchRow row = some[i]->parameters;
    row.insert(row.end(), run.errors.begin(), run.errors.end());
    found.rows.push_back(std::move(row));
  }
  return found;
}

double orderOf(const std::vector<BenchRow>& rows, const char* x, const char* y) {
  std::vector<SizeAndError> points;
  for (const BenchRow& row : rows) points.push_back({figureOf(row, x), figureOf(row, y)});
  return fittedOrder(points);
}

TEST(GradientStudy, CentralDifferencesAreOfSecondOrder) {
  const Found found =
      foundBy("gradients", {{{"library", "Palpate"}, {"operator", "central"}, {"storage", "float"}, {"noise", 0.0}}});
  ASSERT_EQ(found.rows.size(), 3U);
  EXPECT_NEAR(orderOf(found.rows, "voxel_mm", "angle_median_deg"), 2, 0.1);
  EXPECT_NEAR(orderOf(found.rows, "voxel_mm", "length_median_percent"), 2, 0.1);
}

// ITK's central differences are the same formula in the same precision; a half keeps 11 bits, which turns a gradient by
// 2^-11 at most, 0.028 degrees.
TEST(GradientStudy, TheSameFormulaHasTheSameErrorElsewhere) {
  const BenchRow place = {{"operator", "central"}, {"edge_voxels", std::int64_t{48}}, {"noise", 0.0}};
  const Found found = foundBy("gradients", {place});
  ASSERT_EQ(found.rows.size(), 4U);  // Palpate's floats and halves, ITK, OpenVDB
  const double own = figureOf(found.rows[0], "angle_median_deg");
  for (const BenchRow& row : found.rows) {
    const double tolerance = textOf(row, "storage") == "half" ? 0.028 : 1e-4 * own;
    EXPECT_NEAR(figureOf(row, "angle_median_deg"), own, tolerance) << cellKey(row);
  }
  ASSERT_EQ(found.left_out.size(), 2U);  // VTK and SciPy
  for (const std::string& why : found.left_out) EXPECT_THAT(why, HasSubstr("did not start"));
}

TEST(FilterStudy, AGaussianMovesABallBySigmaSquaredOverRadius) {
  const Found found = foundBy("filters", {{{"volume", "ball"}}});
  ASSERT_EQ(found.rows.size(), 5U);
  EXPECT_NEAR(orderOf(found.rows, "sigma_voxel", "surface_moved_voxel"), 2, 0.02);
  for (const BenchRow& row : found.rows) {
    const double sigma = figureOf(row, "sigma_voxel");
    // The kernel ends at three sigmas or a little beyond, where 1.1 to 2.7 % of the variance is missing.
    EXPECT_NEAR(figureOf(row, "surface_moved_voxel") / (sigma * sigma / 30), 0.98, 0.03);
  }
}

TEST(FilterStudy, NoFilterLeavesAllNoise) {
  const Found found = foundBy("filters", {{{"filter", "none"}},
                                          {{"library", "ITK"}, {"filter", "median:1"}},
                                          {{"library", "Palpate"}, {"filter", "median:1"}}});
  ASSERT_EQ(found.rows.size(), 3U);
  EXPECT_NEAR(figureOf(found.rows[0], "noise_left_percent"), 100, 5 * 100 / std::sqrt(2 * 10000.0));
  EXPECT_EQ(figureOf(found.rows[0], "surface_moved_voxel"), 0);
  EXPECT_LT(figureOf(found.rows[1], "noise_left_percent"), 30);
  // A median is one of the values, so both find the same.
  EXPECT_EQ(figureOf(found.rows[1], "noise_left_percent"), figureOf(found.rows[2], "noise_left_percent"));
}

TEST(DrawStudy, DepthsAreOfSecondOrder) {
  const Found found = foundBy("drawing", {{{"volume", "sphere"}, {"kernel", "Palpate, cell tree"}}});
  ASSERT_EQ(found.rows.size(), 3U);
  EXPECT_NEAR(orderOf(found.rows, "voxel_mm", "depth_error_median_um"), 2, 0.1);
  for (const BenchRow& row : found.rows) EXPECT_EQ(figureOf(row, "holes") + figureOf(row, "false_hits"), 0);
}

// A window that is as old as a recession of 10 mm/s makes the depth of 1 mm wrong by 1 % a millisecond.
TEST(PublishStudy, TheErrorIsTheAgeOfTheWindow) {
  const Found found =
      foundBy("publishing", {{{"algorithm", "hri"}, {"speed_m_per_s", 0.05}, {"window_voxels", std::int64_t{32}}}});
  ASSERT_EQ(found.rows.size(), 3U);
  for (const BenchRow& row : found.rows) {
    const double age_ms = figureOf(row, "window_age_median_ms");
    EXPECT_NEAR(figureOf(row, "force_error_median_percent"), age_ms, 0.35) << age_ms;  // interpolation's sag
    EXPECT_EQ(figureOf(row, "missed_ticks"), 0);
  }
}

TEST(ChainStudy, PositionsAreOfSecondOrderAndHalvesNeedLessMemory) {
  const Found found = foundBy("chain", {{{"volume", "sphere"}, {"algorithm", "hri"}}});
  ASSERT_EQ(found.rows.size(), 6U);
  for (const char* storage : {"float", "half"}) {
    std::vector<BenchRow> rows = found.rows;
    std::erase_if(rows, [&](const BenchRow& row) { return textOf(row, "storage") != storage; });
    EXPECT_NEAR(orderOf(rows, "voxel_mm", "vhip_error_median_um"), 2, 0.1) << storage;
  }
  for (std::size_t i = 0; i < found.rows.size(); i += 2) {
    EXPECT_GT(figureOf(found.rows[i], "memory_MiB"), figureOf(found.rows[i + 1], "memory_MiB"));
  }
}

}  // namespace studies_test
}  // namespace palpate
