// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_report.hpp"

#include <regex>

#include <gmock/gmock.h>

#include "apps/study/error_bench.hpp"
#include "apps/study/study_analysis.hpp"
#include "apps/study/study_chart.hpp"

namespace palpate {
namespace study_report_test {

using testing::HasSubstr;
using testing::Not;

BenchRow row(const std::string& algorithm, std::int64_t n, double cost_ns, double error_voxel) {
  return {{"part", "servo"},
          {"algorithm", algorithm},
          {"n_ticks", n},
          {"n", "n=" + std::to_string(n)},
          {"renews_planes", "yes"},
          {"speed_m_per_s", 0.1},
          {"noise_voxel", 0.0},
          {"depth_voxel", 1.0},
          {"radius", "20 mm"},
          {"cell", n},
          {"fall_throughs", std::int64_t{0}},
          {"age_way_mm", 0.5 * static_cast<double>(n)},
          {"vhip_error_max_um", 6.0 * static_cast<double>(n * n)},
          {"vhip_error_p99_voxel", error_voxel},
          {"cost_ns", cost_ns},
          {"cost_ns_each", "1 2 3"}};
}

BenchResult someResult() {
  BenchResult result;
  result.bench = "error";
  result.machine = "a <b>machine</b>";
  result.command = "palpate bench error --seed 1";
  result.rows.push_back({{"part", "shard"},
                         {"shard", std::int64_t{1}},
                         {"shards", std::int64_t{1}},
                         {"cells", std::int64_t{4}},
                         {"machine", "a <b>machine</b>"}});
  result.rows.push_back(row("hri", 5, 30, 0.01));
  result.rows.push_back(row("hri", 10, 20, 0.05));
  result.rows.push_back(row("hri-paper", 5, 15, 0.2));
  result.rows.push_back(row("blezek", 1, 90, 0.02));
  analyse(result);
  return result;
}

// The style of all reports gives a heading 40 % of a table's width and breaks words where a column has no room. In a
// table of four columns nothing would be left for the last one, the verdict, which then stood one letter a line. So
// every table with a row of headings takes both back: by a class whose headings have the width they need and are not
// broken.
TEST(StudyReport, VerdictsHaveRoom) {
  BenchResult result = someResult();
  result.targets = {{.name = std::string(300, 'x'), .value = 1, .bound = 2}, {.name = "b", .value = 3, .bound = 2}};
  const std::string page = errorReport(result);
  static const std::regex kHeaded("<table( class=\"[a-z]+\")?>\\s*<tr><th>");
  int tables = 0;
  for (auto it = std::sregex_iterator(page.begin(), page.end(), kHeaded); it != std::sregex_iterator();
       ++it, ++tables) {
    const std::string name = (*it)[1];
    EXPECT_THAT(name, testing::AnyOf(" class=\"targets\"", " class=\"wide\"")) << it->str();
  }
  EXPECT_GT(tables, 2);
  for (const char* rule : {"table.wide th { width: auto; white-space: nowrap; }", "table.targets th { width: auto; }",
                           "table.targets td:not(:first-child), table.targets th { white-space: nowrap; }"}) {
    EXPECT_THAT(page, HasSubstr(rule));
  }
  EXPECT_THAT(page, HasSubstr("<td>3</td><td>2</td><td><b>does not hold</b></td>"));
}

TEST(StudyReport, NeedsNothingButABrowser) {
  const std::string page = errorReport(someResult());
  EXPECT_THAT(page, testing::StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, testing::EndsWith("</html>\n"));
  // The only address is the name space of SVG, which is fetched by nobody.
  const std::string without = std::regex_replace(page, std::regex("xmlns=\"http://www.w3.org/2000/svg\""), "");
  for (const char* outside : {"http:", "https:", "src=", "url(", "@import", "<script"}) {
    EXPECT_THAT(without, Not(HasSubstr(outside))) << outside;
  }
}

TEST(StudyReport, ShowsPlotsFrontsDefaultsOrdersTargetsAndCells) {
  const std::string page = errorReport(someResult());
  for (const char* words : {"<svg", "Pareto front", ">hri<", ">hri-paper<", ">blezek<", "n=5 (default)",
                            "Pareto fronts</h3>", "The defaults</h3>", "What is promised", "All 4 cells",
                            "cells whose errors differ from round to round", "(v n T)^2 / (2 R)"}) {
    EXPECT_THAT(page, HasSubstr(words)) << words;
  }
  EXPECT_THAT(page, HasSubstr("a &lt;b&gt;machine&lt;/b&gt;"));  // nothing from outside becomes markup
  EXPECT_THAT(page, Not(HasSubstr("<b>machine")));
  EXPECT_THAT(page, Not(HasSubstr("1 2 3")));  // single costs are in the JSON
}

TEST(StudyChart, MarksTheFrontAndTheDefault) {
  const std::string chart = logChartSvg(errorCharts(someResult()));
  EXPECT_THAT(chart, testing::StartsWith("<svg"));
  EXPECT_THAT(chart, testing::EndsWith("</svg>\n"));
  // In "position" three are on the front, and blezek is not; each has a ring, and the legend shows one.
  const std::size_t begin = chart.find(">position<"), end = chart.find("</g>", begin);
  const std::string panel = chart.substr(begin, end - begin);
  std::size_t rings = 0;
  for (std::size_t at = panel.find("<ellipse"); at != std::string::npos; at = panel.find("<ellipse", at + 1)) ++rings;
  EXPECT_EQ(rings, 3U);
  EXPECT_THAT(panel, HasSubstr(">n=5 (default)<"));
}

TEST(StudyChart, WithoutRowsIsStillAPicture) {
  EXPECT_THAT(logChartSvg(errorCharts(BenchResult{})), testing::EndsWith("</svg>\n"));
  EXPECT_THAT(errorReport(BenchResult{}), testing::EndsWith("</html>\n"));
  EXPECT_EQ(errorTable(BenchResult{}), "");
}

TEST(ErrorTable, SaysWhatTheFrontsSayOfTheDefaults) {
  EXPECT_THAT(errorTable(someResult()), testing::ContainsRegex("servo +position +hri n=5 +on the front\n"));
  BenchResult worse = someResult();
  worse.rows.clear();
  worse.rows = {row("hri", 5, 30, 0.01), row("avila", 1, 15, 0.005)};
  analyse(worse);
  EXPECT_THAT(errorTable(worse), HasSubstr("beaten by 1 choice (1 of rivals), most by avila n=1: 0.50 of its cost, "
                                           "0.50 of its error"));
}

}  // namespace study_report_test
}  // namespace palpate
