// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/log_chart.hpp"

#include <regex>

#include <gmock/gmock.h>

namespace palpate {
namespace {

using testing::HasSubstr;

std::vector<double> centresX(const std::string& svg) {
  std::vector<double> xs;
  static const std::regex kCircle("<circle cx=\"([0-9.]+)\"");
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kCircle); it != std::sregex_iterator(); ++it) {
    xs.push_back(std::stod((*it)[1]));
  }
  return xs;
}

ChartPanel panelOf(std::vector<ChartPoint> points) {
  return {"panel", "cost [ns]", "error [voxel]", {{"hri", std::move(points)}}};
}

// Equal ratios are equal distances. Positions are written with one decimal, so a distance is true to 0.1.
TEST(LogChart, AxesAreLogarithmic) {
  const std::string svg =
      logChartSvg("chart", {panelOf({{1, 1, "n=1"}, {10, 2, "n=5"}, {100, 4, ""}})}, ChartMarks::kPoints);
  const std::vector<double> xs = centresX(svg);
  ASSERT_EQ(xs.size(), 4U);  // and one in the legend
  EXPECT_NEAR(xs[1] - xs[0], xs[2] - xs[1], 0.11);
  EXPECT_GT(xs[1] - xs[0], 100);
  for (const char* words : {"chart", "panel", "cost [ns]", "error [voxel]", "hri", "n=1", "n=5", ">10<"}) {
    EXPECT_THAT(svg, HasSubstr(words));
  }
}

TEST(LogChart, WhatHasNoLogarithmIsLeftOut) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::string svg =
      logChartSvg("chart", {panelOf({{1, 0, ""}, {-1, 1, ""}, {inf, 1, ""}, {2, 3, ""}})}, ChartMarks::kPoints);
  EXPECT_EQ(centresX(svg).size(), 2U);
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
  EXPECT_THAT(svg, testing::Not(HasSubstr("inf")));
}

TEST(LogChart, NothingToDrawIsStillAPicture) {
  EXPECT_THAT(logChartSvg("empty", {}, ChartMarks::kLine), testing::EndsWith("</svg>\n"));
  EXPECT_THAT(logChartSvg("empty", {panelOf({})}, ChartMarks::kLine), testing::Not(HasSubstr("nan")));
}

TEST(LogChart, NamesCannotBreakTheFile) {
  const std::string svg = logChartSvg("<b>&", {}, ChartMarks::kPoints);
  EXPECT_THAT(svg, HasSubstr("&lt;b&gt;&amp;"));
}

TEST(LogChart, ASeriesHasTheSameMarkInEveryPanel) {
  ChartPanel second = panelOf({{1, 1, ""}, {3, 3, ""}});
  second.series.insert(second.series.begin(), {"blezek", {{2, 2, ""}}});
  const std::string svg = logChartSvg("chart", {panelOf({{1, 1, ""}}), second}, ChartMarks::kPoints);
  EXPECT_EQ(centresX(svg).size(), 4U);  // hri: one, two, and the legend's
}

}  // namespace
}  // namespace palpate
