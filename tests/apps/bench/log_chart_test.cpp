// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/log_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "apps/bench/random.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace log_chart_test {

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
      logChartSvg({{"chart", {panelOf({{1, 1, "n=1"}, {10, 2, "n=5"}, {100, 4, ""}})}, ChartMarks::kPoints}});
  const std::vector<double> xs = centresX(svg);
  ASSERT_EQ(xs.size(), 4U);  // and one in the legend
  EXPECT_NEAR(xs[1] - xs[0], xs[2] - xs[1], 0.11);
  EXPECT_GT(xs[1] - xs[0], 100);
  for (const char* words : {"chart", "panel", "cost [ns]", "error [voxel]", "hri", "n=1", "n=5", ">10<"}) {
    EXPECT_THAT(svg, HasSubstr(words));
  }
}

// The axes go from 78 to 444 and from 334 up to 30. Two decades and 0.15 of one at either end: 1 lies at 0.15 / 2.3 of
// the way, 10 in the middle.
TEST(LogChart, PointsLieWhereTheirLogarithmsAre) {
  const std::string svg =
      logChartSvg({{"chart", {panelOf({{1, 1, ""}, {10, 10, ""}, {100, 100, ""}})}, ChartMarks::kPoints}});
  for (const char* at : {"cx=\"101.9\" cy=\"314.2\"", "cx=\"261.0\" cy=\"182.0\"", "cx=\"420.1\" cy=\"49.8\""}) {
    EXPECT_THAT(svg, HasSubstr(at));
  }
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"101.9,314.2 261.0,182.0 420.1,49.8 \""));
  EXPECT_THAT(svg, HasSubstr("stroke-width=\"0.8\""));
  // A line at 10 from top to bottom, and one across.
  EXPECT_THAT(svg, HasSubstr("<line x1=\"261.0\" y1=\"30.0\" x2=\"261.0\" y2=\"334.0\""));
  EXPECT_THAT(svg, HasSubstr("<line x1=\"78.0\" y1=\"182.0\" x2=\"444.0\" y2=\"182.0\""));
  for (const char* tick : {">1<", ">2<", ">5<", ">10<", ">20<", ">50<", ">100<"}) EXPECT_THAT(svg, HasSubstr(tick));
  for (const char* beyond : {">0.5<", ">200<"}) EXPECT_THAT(svg, testing::Not(HasSubstr(beyond)));
}

// Three decades have air of 6 % at either end, and their powers of ten alone.
TEST(LogChart, ManyDecadesHaveTheirPowersOfTenAlone) {
  const std::string svg = logChartSvg({{"chart", {panelOf({{1, 1, ""}, {1000, 1000, ""}})}, ChartMarks::kLine}});
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"97.6,317.7 424.4,46.3 \""));
  EXPECT_THAT(svg, HasSubstr("stroke-width=\"1.8\""));
  EXPECT_EQ(centresX(svg).size(), 1U);  // the legend's
  for (const char* tick : {">1<", ">10<", ">100<", ">1000<"}) EXPECT_THAT(svg, HasSubstr(tick));
  for (const char* step : {">2<", ">5<", ">20<", ">500<"}) EXPECT_THAT(svg, testing::Not(HasSubstr(step)));
}

TEST(LogChart, PointsOfOneSeriesAreTogether) {
  std::vector<ChartPanel> panels;
  const ChartPanel first{"first", "x", "y", {}}, second{"second", "x", "y", {}};
  addPoint(panels, first, "a", {1, 2, ""});
  addPoint(panels, second, "a", {3, 4, ""});
  addPoint(panels, first, "b", {5, 6, ""});
  addPoint(panels, first, "a", {7, 8, ""});
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[1].title, "second");
  ASSERT_EQ(panels[0].series.size(), 2U);
  EXPECT_EQ(panels[0].series[1].name, "b");
  ASSERT_EQ(panels[0].series[0].points.size(), 2U);
  EXPECT_EQ(panels[0].series[0].points[1].x, 7);
  EXPECT_EQ(panels[0].series[0].points[1].y, 8);
}

// Marks that almost lie on each other, and one at the right edge: no label over another or beyond the axes. A letter of
// DejaVu Sans is at most 6.4 pixels wide at size 10, as the digits and "=" are.
TEST(LogChart, LabelsStayApartAndInside) {
  std::vector<ChartPoint> points;
  for (int i = 0; i < 5; ++i) points.push_back({1 + 0.02 * i, 1 + 0.03 * (i % 2), "n=50"});
  points.push_back({1000, 1000, "any n"});
  const std::string svg = logChartSvg({{"chart", {panelOf(points)}, ChartMarks::kPoints}});
  static const std::regex kLabel(
      "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"start\" font-size=\"10\"[^>]*>([^<]*)<");
  std::vector<std::array<double, 3>> labels;  // left, baseline, right
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kLabel); it != std::sregex_iterator(); ++it) {
    const double left = std::stod((*it)[1]);
    labels.push_back({left, std::stod((*it)[2]), left + 6.4 * static_cast<double>((*it)[3].length())});
  }
  ASSERT_EQ(labels.size(), 6U);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_LE(labels[i][2], 460 - 16);  // where the axes end
    for (std::size_t j = 0; j < i; ++j) {
      const bool beside = labels[i][2] <= labels[j][0] || labels[j][2] <= labels[i][0];
      EXPECT_TRUE(beside || std::abs(labels[i][1] - labels[j][1]) >= 9.9) << i << " over " << j;
    }
  }
}

// Values of any size, whose last tick may lie at the very end of an axis: every number stays within its panel, 460
// wide, and clear of the words beside the axis, which end at 20. A digit of DejaVu Sans is 0.64 times its size wide, a
// plus 0.84.
TEST(LogChart, NumbersAtTheAxesAreWhole) {
  Random random(11);
  static const std::regex kNumber("<text x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"(middle|end)\">([-+.0-9e]+)<");
  int seen = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto any = [&] { return std::pow(10.0, random.uniform(-6, 12)); };
    const double x = any(), y = any(), spread = std::pow(10.0, random.uniform(0, 5));
    const std::string svg =
        logChartSvg({{"chart", {panelOf({{x, y, ""}, {x * spread, y * spread, ""}})}, ChartMarks::kLine}});
    for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kNumber); it != std::sregex_iterator(); ++it, ++seen) {
      const std::string words = (*it)[3];
      const auto pluses = static_cast<double>(std::count(words.begin(), words.end(), '+'));
      const double width = 12 * (0.64 * static_cast<double>(words.size()) + 0.2 * pluses), at = std::stod((*it)[1]);
      const bool below = (*it)[2] == "middle";
      // A tenth of a pixel: the places are rounded to it.
      EXPECT_LE(below ? at + width / 2 : at, 460.1) << words << " at " << x << " to " << x * spread;
      EXPECT_GE(below ? at - width / 2 : at - width, 20) << words << " at " << y << " to " << y * spread;
    }
  }
  EXPECT_GT(seen, 4000);
}

TEST(LogChart, WhatHasNoLogarithmIsLeftOut) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::string svg =
      logChartSvg({{"chart", {panelOf({{1, 0, ""}, {-1, 1, ""}, {inf, 1, ""}, {2, 3, ""}})}, ChartMarks::kPoints}});
  EXPECT_EQ(centresX(svg).size(), 2U);
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
  EXPECT_THAT(svg, testing::Not(HasSubstr("inf")));
}

TEST(LogChart, NothingToDrawIsStillAPicture) {
  EXPECT_THAT(logChartSvg({{"empty", {}, ChartMarks::kLine}}), testing::EndsWith("</svg>\n"));
  EXPECT_THAT(logChartSvg({{"empty", {panelOf({})}, ChartMarks::kLine}}), testing::Not(HasSubstr("nan")));
}

TEST(LogChart, NamesCannotBreakTheFile) {
  const std::string svg = logChartSvg({{"<b>&", {}, ChartMarks::kPoints}});
  EXPECT_THAT(svg, HasSubstr("&lt;b&gt;&amp;"));
}

TEST(LogChart, ASeriesHasTheSameMarkInEveryPanel) {
  ChartPanel second = panelOf({{1, 1, ""}, {3, 3, ""}});
  second.series.insert(second.series.begin(), {"blezek", {{2, 2, ""}}});
  const std::string svg = logChartSvg({{"chart", {panelOf({{1, 1, ""}}), second}, ChartMarks::kPoints}});
  EXPECT_EQ(centresX(svg).size(), 4U);  // hri: one, two, and the legend's
}

// The element that draws each mark, without its place and colour.
TEST(LogChart, TwelveSeriesAreToldApartWithoutColours) {
  ChartPanel panel{"panel", "x", "y", {}};
  for (int i = 0; i < 12; ++i) panel.series.push_back({"series " + std::to_string(i), {}, SeriesLook::kMarksAlone});
  const std::string svg = logChartSvg({{"chart", {panel}, ChartMarks::kPoints}});
  const std::string legend = svg.substr(svg.find("</g>"));
  std::set<std::string> marks;
  static const std::regex kMark("<(circle|rect|path)[^>]*>"), kPlace("(cx|cy|x|y)=\"[0-9.]+\"|M[0-9.]+ [0-9.]+"),
      kColor("#[0-9a-f]{6}");
  for (auto it = std::sregex_iterator(legend.begin(), legend.end(), kMark); it != std::sregex_iterator(); ++it) {
    marks.insert(std::regex_replace(std::regex_replace(it->str(), kPlace, ""), kColor, ""));
  }
  EXPECT_EQ(marks.size(), 12U);
}

// The front goes down from the top of the axes, in steps through its points, and on to the right end.
TEST(LogChart, AFrontHasRingsAndSteps) {
  ChartPanel panel{"panel", "cost", "error", {}};
  panel.series.push_back({"a", {{1, 100, "", true}, {100, 1, "", true}, {100, 100, ""}}, SeriesLook::kMarksAlone});
  const std::string svg = logChartSvg({{"chart", {panel}, ChartMarks::kPoints}});
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"101.9,30.0 101.9,49.8 420.1,49.8 420.1,314.2 444.0,314.2\""));
  for (const char* ring : {"<ellipse cx=\"101.9\" cy=\"49.8\"", "<ellipse cx=\"420.1\" cy=\"314.2\"", "Pareto front"}) {
    EXPECT_THAT(svg, HasSubstr(ring));
  }
  EXPECT_THAT(svg, testing::Not(HasSubstr("<ellipse cx=\"420.1\" cy=\"49.8\"")));
  panel.series[0].points = {{1, 100, ""}};
  EXPECT_THAT(logChartSvg({{"chart", {panel}, ChartMarks::kPoints}}), testing::Not(HasSubstr("Pareto front")));
}

TEST(LogChart, AFormulaIsADashedLineWithoutMarks) {
  ChartPanel panel{"panel", "x", "y", {}};
  panel.series.push_back({"x^2", {{1, 1, ""}, {10, 100, ""}}, SeriesLook::kDashed});
  const std::string svg = logChartSvg({{"chart", {panel}, ChartMarks::kPoints}});
  EXPECT_TRUE(centresX(svg).empty());
  EXPECT_THAT(svg, testing::ContainsRegex("<polyline points=\"[0-9., ]+\"[^>]*stroke-dasharray"));
  EXPECT_THAT(svg, HasSubstr(">x^2<"));
}

// Panels of 460 x 380 below a title of 30, and a line of 22 for the legend.
TEST(LogChart, PanelsAreLaidOutInColumns) {
  const std::vector<ChartPanel> panels(5, panelOf({{1, 1, ""}}));
  EXPECT_THAT(logChartSvg({{"chart", panels, ChartMarks::kPoints}}), HasSubstr("width=\"2300\" height=\"432\""));
  const std::string svg = logChartSvg({{"chart", panels, ChartMarks::kPoints, 3}});
  EXPECT_THAT(svg, HasSubstr("width=\"1380\" height=\"812\""));
  EXPECT_THAT(svg, HasSubstr("translate(920 30)"));
  EXPECT_THAT(svg, HasSubstr("translate(460 410)"));
  EXPECT_THAT(logChartSvg({{"chart", {panels[0]}, ChartMarks::kPoints, 3}}), HasSubstr("width=\"460\" height=\"432\""));
}

TEST(LogChart, ALegendThatIsLongHasSeveralLines) {
  ChartPanel panel{"panel", "x", "y", {}};
  for (int i = 0; i < 12; ++i) panel.series.push_back({"a library with a long name " + std::to_string(i), {}});
  const std::string svg = logChartSvg({{"chart", {panel}, ChartMarks::kPoints}});
  EXPECT_THAT(svg, HasSubstr("width=\"460\" height=\"674\""));  // twelve lines
  static const std::regex kText("<text x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"start\">");
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kText); it != std::sregex_iterator(); ++it) {
    EXPECT_LT(std::stod((*it)[1]), 100);
  }
}

LogCharts twoCharts() {
  const auto titled = [](const char* title) {
    ChartPanel panel = panelOf({{1, 1, ""}});
    panel.title = title;
    return panel;
  };
  return {{"upper", {titled("depth"), titled("noise")}}, {"lower", {titled("memory")}}};
}

TEST(LogChart, ChartsStandBelowEachOther) {
  const std::string svg = logChartSvg(twoCharts());
  const std::string one = logChartSvg({twoCharts()[1]});
  // The upper chart has two panels and so the width; both have a title, one row of panels and a line of the legend.
  EXPECT_THAT(svg, HasSubstr("width=\"920\" height=\"864\""));
  EXPECT_THAT(one, HasSubstr("width=\"460\" height=\"432\""));
  EXPECT_LT(svg.find(">upper<"), svg.find("translate(0 432)"));
  EXPECT_GT(svg.find(">lower<"), svg.find("translate(0 432)"));
}

TEST(OnlyPanels, LeavesThoseAskedForInTheirOrder) {
  const LogCharts charts = onlyPanels(twoCharts(), {"memory", "noise"});
  ASSERT_EQ(charts.size(), 2U);
  ASSERT_EQ(charts[0].panels.size(), 1U);
  EXPECT_EQ(charts[0].panels[0].title, "noise");
  EXPECT_EQ(charts[1].panels[0].title, "memory");
}

TEST(OnlyPanels, AChartWithoutPanelsIsLeftOut) {
  const LogCharts charts = onlyPanels(twoCharts(), {"memory"});
  ASSERT_EQ(charts.size(), 1U);
  EXPECT_EQ(charts[0].title, "lower");
}

TEST(OnlyPanels, RefusesATitleThatNoPanelHas) {
  EXPECT_THAT(refusalOf([] {
                (void)onlyPanels(twoCharts(), {"noise", "memroy"});
              }),
              testing::AllOf(HasSubstr("memroy"), HasSubstr("memory")));
  EXPECT_THAT(refusalOf([] { (void)onlyPanels(twoCharts(), {"force"}); }), HasSubstr("depth; noise; memory"));
}

}  // namespace log_chart_test
}  // namespace palpate
