// SPDX-License-Identifier: Apache-2.0
// The rows are made up, so that fronts and orders are known beforehand.
#include "apps/study/study_analysis.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace study_analysis_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A row of the servo study as its plot "position" shows it.
BenchRow servoRow(const std::string& algorithm, std::int64_t n, double cost_ns, double error_voxel) {
  return {{"part", "servo"},        {"algorithm", algorithm},
          {"n_ticks", n},           {"n", "n=" + std::to_string(n)},
          {"renews_planes", "yes"}, {"speed_m_per_s", 0.1},
          {"noise_voxel", 0.0},     {"depth_voxel", 1.0},
          {"radius", "20 mm"},      {"fall_throughs", std::int64_t{0}},
          {"errors_repeat", "yes"}, {"vhip_error_p99_voxel", error_voxel},
          {"cost_ns", cost_ns}};
}

BenchResult resultOf(std::vector<BenchRow> rows) {
  BenchResult result;
  result.bench = "error";
  result.rows = std::move(rows);
  return result;
}

const BenchTarget* targetOf(const BenchResult& result, const std::string& words) {
  for (const BenchTarget& target : result.targets) {
    if (target.name.find(words) != std::string::npos) return &target;
  }
  return nullptr;
}

TEST(StudyAnalysis, AFrontHasTheChoicesThatNoneBeats) {
  BenchResult result = resultOf({servoRow("hri", 5, 30, 0.01), servoRow("avila", 1, 60, 0.005),
                                 servoRow("blezek", 1, 70, 0.02), servoRow("hri", 50, 10, 0.5)});
  analyse(result);
  const BenchRows front = rowsOf(result, "front", {{"plot", "position"}});
  ASSERT_THAT(front, SizeIs(3));
  EXPECT_EQ(wordsOf(*front[0], {"series", "choice"}), "hri n=50");
  EXPECT_EQ(wordsOf(*front[1], {"series", "choice"}), "hri n=5");
  EXPECT_EQ(wordsOf(*front[2], {"series", "choice"}), "avila n=1");
  EXPECT_EQ(figureOf(*front[1], "cost"), 30);
  EXPECT_EQ(figureOf(*front[1], "error"), 0.01);
  EXPECT_EQ(figureOf(*front[1], "place"), 2);
}

TEST(StudyAnalysis, ADefaultOnTheFrontIsBeatenByNone) {
  BenchResult result = resultOf({servoRow("hri", 5, 30, 0.01), servoRow("blezek", 1, 70, 0.02)});
  analyse(result);
  const BenchRows says = rowsOf(result, "default", {{"plot", "position"}});
  ASSERT_THAT(says, SizeIs(1));
  EXPECT_EQ(textOf(*says[0], "on_front"), "yes");
  EXPECT_EQ(figureOf(*says[0], "beaten_by"), 0);
  const BenchTarget* target = targetOf(result, "rivals that cost less and err less");
  ASSERT_NE(target, nullptr);
  EXPECT_TRUE(target->holds());
}

// Three beat it, two of them of other algorithms. The best has a fifth of its cost and half of its error.
TEST(StudyAnalysis, WhatBeatsADefaultIsTold) {
  BenchResult result =
      resultOf({servoRow("hri", 5, 100, 0.01), servoRow("hri", 10, 90, 0.009), servoRow("blezek", 1, 50, 0.01),
                servoRow("avila", 1, 20, 0.005), servoRow("implicit", 1, 200, 0.001)});
  analyse(result);
  const BenchRows says = rowsOf(result, "default", {{"plot", "position"}});
  ASSERT_THAT(says, SizeIs(1));
  EXPECT_EQ(textOf(*says[0], "on_front"), "no");
  EXPECT_EQ(figureOf(*says[0], "beaten_by"), 3);
  EXPECT_EQ(figureOf(*says[0], "beaten_by_rivals"), 2);
  EXPECT_EQ(textOf(*says[0], "best"), "avila n=1");
  EXPECT_DOUBLE_EQ(figureOf(*says[0], "cost_ratio"), 0.2);
  EXPECT_DOUBLE_EQ(figureOf(*says[0], "error_ratio"), 0.5);
  EXPECT_FALSE(targetOf(result, "rivals that cost less and err less")->holds());
}

TEST(StudyAnalysis, RowsWithoutOneOfTheFiguresAreNotShown) {
  BenchRow left_out = servoRow("blezek", 1, 1, 1);
  std::erase_if(left_out, [](const auto& cell) { return cell.first == "cost_ns"; });
  BenchResult result = resultOf({servoRow("hri", 5, 30, std::nan("")), left_out, servoRow("avila", 1, 9, 9)});
  analyse(result);
  EXPECT_THAT(rowsOf(result, "front", {{"plot", "position"}}), SizeIs(1));
  EXPECT_THAT(rowsOf(result, "default", {{"plot", "position"}}), IsEmpty());
}

// The error is C way^p exactly, for two families: off theory's 2 by 0.05 and by 0.3.
TEST(StudyAnalysis, OrdersAreFittedFamilyByFamily) {
  std::vector<BenchRow> rows;
  for (const double way_mm : {0.1, 2.0, 3.0, 5.0, 90.0}) {  // the first and the last are out of the range
    for (const auto& [algorithm, order] : {std::pair{"hri-paper", 2.05}, std::pair{"hri-paper-line", 1.7}}) {
      BenchRow row = servoRow(algorithm, 5, 10, 0.1);
      row.emplace_back("age_way_mm", way_mm);
      const bool inside = way_mm > 1 && way_mm < 6;
      row.emplace_back("vhip_error_max_um", inside ? 3 * std::pow(way_mm, order) : 1e3);
      rows.push_back(std::move(row));
    }
  }
  BenchResult result = resultOf(std::move(rows));
  analyse(result);
  const BenchRows orders = rowsOf(result, "order", {{"study", "servo"}});
  ASSERT_THAT(orders, SizeIs(2));
  EXPECT_EQ(textOf(*orders[0], "family"), "hri-paper");
  EXPECT_EQ(figureOf(*orders[0], "points"), 3);
  EXPECT_NEAR(figureOf(*orders[0], "fitted_order"), 2.05, 1e-12);
  EXPECT_EQ(figureOf(*orders[0], "theory_order"), 2);
  EXPECT_NEAR(figureOf(*orders[1], "fitted_order"), 1.7, 1e-12);
  const BenchTarget* target = targetOf(result, "servo: fitted order");
  ASSERT_NE(target, nullptr);
  EXPECT_THAT(target->name, HasSubstr("worst of 2 families"));
  EXPECT_NEAR(target->value, 0.3, 1e-12);
  EXPECT_FALSE(target->holds());
}

// Of two algorithms, one of which lost contact in two of three cells.
TEST(StudyAnalysis, CountsAreSummedByName) {
  std::vector<BenchRow> rows;
  for (const std::int64_t falls : {0, 2, 5}) {
    for (const char* algorithm : {"hri", "hri-paper"}) {
      rows.push_back(servoRow(algorithm, falls, 10, 0.1));
      std::erase_if(rows.back(), [](const auto& cell) { return cell.first == "fall_throughs"; });
      rows.back().emplace_back("fall_throughs", algorithm == std::string("hri") ? 0 : falls);
    }
  }
  BenchResult result = resultOf(std::move(rows));
  analyse(result);
  const BenchRows counts = rowsOf(result, "count", {{"of", "fall_throughs"}});
  ASSERT_THAT(counts, SizeIs(2));
  EXPECT_EQ(wordsOf(*counts[0], {"who", "sum", "cells_with", "cells"}), "hri 0 0 3");
  EXPECT_EQ(wordsOf(*counts[1], {"who", "sum", "cells_with", "cells"}), "hri-paper 7 2 3");
}

TEST(StudyAnalysis, CellsWhoseErrorsDifferBreakAPromise) {
  BenchRow drifts = servoRow("hri", 5, 30, 0.01);
  for (auto& [key, figure] : drifts) {
    if (key == "errors_repeat") figure = "no";
  }
  BenchResult result = resultOf({drifts, servoRow("hri", 1, 30, 0.01)});
  analyse(result);
  const BenchTarget* target = targetOf(result, "errors differ from round to round");
  ASSERT_NE(target, nullptr);
  EXPECT_EQ(target->value, 1);
}

TEST(StudyAnalysis, WithoutCellsNothingIsSaid) {
  BenchResult result = resultOf({{{"part", "note"}, {"note", "nothing was measured"}}});
  analyse(result);
  EXPECT_THAT(result.rows, SizeIs(1));
  EXPECT_THAT(result.targets, IsEmpty());
}

TEST(Studies, AreNamedOnceAndAnUnknownOneIsRefused) {
  std::vector<std::string> names;
  for (const Study& study : studies()) {
    EXPECT_EQ(&studyNamed(study.name), &study);
    names.emplace_back(study.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
  try {
    static_cast<void>(studyNamed("serwo"));
    ADD_FAILURE();
  } catch (const Error& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("--study serwo"));
    EXPECT_THAT(refusal.what(), HasSubstr("did you mean servo?"));
  }
}

// A shard is a part of the list, so the list must be the same whenever the settings are.
TEST(Studies, TheirCellsAreDifferentAndTheListIsTheSameAgain) {
  for (const bool quick : {false, true}) {
    for (const Study& study : studies()) {
      const StudySettings settings{.quick = quick, .seed = 3};
      std::vector<std::string> keys, again;
      for (const StudyCell& cell : study.cells(settings)) keys.push_back(cellKey(cell.parameters));
      for (const StudyCell& cell : study.cells(settings)) again.push_back(cellKey(cell.parameters));
      EXPECT_FALSE(keys.empty()) << study.name;
      EXPECT_EQ(keys, again);
      std::sort(keys.begin(), keys.end());
      EXPECT_EQ(std::unique(keys.begin(), keys.end()), keys.end()) << study.name;
    }
  }
}

}  // namespace study_analysis_test
}  // namespace palpate
