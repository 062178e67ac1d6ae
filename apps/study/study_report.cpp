// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_report.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/report/html_text.hpp"
#include "apps/report/page_files.hpp"
#include "apps/study/study_analysis.hpp"
#include "apps/study/study_chart.hpp"

namespace palpate {
namespace {

// Beside the style of other reports: pictures on white, and pages that break between plots and not in them.
constexpr const char* kStudyCss = R"(
section svg { display: block; max-width: 100%; height: auto; border: 1px solid var(--line); border-radius: 6px; }
table.wide th { width: auto; white-space: nowrap; }
table.wide td, table.wide th { padding-right: 10px; font-size: 13px; }
table.targets th { width: auto; }
table.targets td:not(:first-child), table.targets th { white-space: nowrap; }
.scroll { overflow-x: auto; }
@media print {
  :root { --paper: #fff; --ink: #000; --soft: #333; --line: #999; --card: #fff; }
  section svg, tr { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  details { display: none; }
}
)";

struct HtmlColumn {
  std::string key, heading;
  int digits = -1;
};

std::string htmlTable(const BenchRows& rows, const std::vector<HtmlColumn>& columns) {
  std::string text = "<div class=\"scroll\"><table class=\"wide\">\n<tr>";
  for (const HtmlColumn& column : columns) text += fmt::format("<th>{}</th>", escapeHtml(column.heading));
  text += "</tr>\n";
  for (const BenchRow* row : rows) {
    text += "<tr>";
    for (const HtmlColumn& column : columns) {
      text += fmt::format("<td>{}</td>", escapeHtml(cellText(*row, column.key, 0, column.digits)));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string headOf(const BenchResult& result) {
  return fmt::format(
      R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>Palpate: error against run time</title>
<style>
{}{}</style>
</head>
<body>
<main>
<header>
<p class="kind">Palpate bench report</p>
<h1>Error against run time</h1>
<p class="verdict">{} of {} targets hold.</p>
</header>
<p>Machine: {}. Vulkan device: {}. Commit: {}. Command: <code>{}</code></p>
)",
      kReportCss, kStudyCss, std::ranges::count_if(result.targets, &BenchTarget::holds), result.targets.size(),
      escapeHtml(result.machine), escapeHtml(result.vulkan_device), escapeHtml(result.commit),
      escapeHtml(result.command));
}

std::string targetSection(const BenchResult& result) {
  std::string text =
      "<section>\n<h2>What is promised</h2>\n<table class=\"targets\">\n<tr><th>target</th><th>value</th><th>at "
      "most</th><th></th></tr>\n";
  for (const BenchTarget& target : result.targets) {
    text += fmt::format("<tr><td>{}</td><td>{:.4g}</td><td>{:g}</td><td>{}</td></tr>\n", escapeHtml(target.name),
                        target.value, target.bound, target.holds() ? "holds" : "<b>does not hold</b>");
  }
  text += "</table>\n";
  for (const BenchRow* note : rowsOf(result, "note")) {
    text += fmt::format("<p class=\"hint\">Note: {}</p>\n", escapeHtml(textOf(*note, "note")));
  }
  return text + "</section>\n";
}

// Every figure that its cells have, but the lists of single costs.
std::vector<HtmlColumn> columnsOf(const BenchRows& rows) {
  std::vector<HtmlColumn> columns;
  for (const BenchRow* row : rows) {
    for (const auto& [key, figure] : *row) {
      const bool known = std::ranges::find(columns, key, &HtmlColumn::key) != columns.end();
      if (!known && key != "part" && !key.ends_with("_each")) columns.push_back({key, keyInWords(key)});
    }
  }
  return columns;
}

std::string studySection(const BenchResult& result, const Study& study) {
  const BenchRows cells = rowsOf(result, study.name);
  if (cells.empty()) return "";
  const BenchRow own = {{"study", study.name}};
  std::string text = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n", study.name, escapeHtml(study.title),
                                 escapeHtml(study.words));
  text += logChartSvg(studyCharts(result, study, isQuick(result)));
  if (const BenchRows rows = rowsOf(result, "default", own); !rows.empty()) {
    text += "<h3>The defaults</h3>\n" + htmlTable(rows, {{"plot", "plot"},
                                                         {"default", "default"},
                                                         {"on_front", "on the front"},
                                                         {"beaten_by", "beaten by"},
                                                         {"beaten_by_rivals", "of them rivals"},
                                                         {"best", "most by"},
                                                         {"cost_ratio", "its cost / the default's", 2},
                                                         {"error_ratio", "its error / the default's", 2}});
  }
  if (const BenchRows rows = rowsOf(result, "order", own); !rows.empty()) {
    text += "<h3>Orders of convergence</h3>\n" + htmlTable(rows, {{"what", "what"},
                                                                  {"family", "family"},
                                                                  {"points", "cells"},
                                                                  {"fitted_order", "fitted", 3},
                                                                  {"theory_order", "theory"}});
  }
  if (const BenchRows rows = rowsOf(result, "count", own); !rows.empty()) {
    text +=
        "<h3>What went wrong</h3>\n" +
        htmlTable(rows, {{"of", "what"}, {"who", "who"}, {"sum", "sum"}, {"cells_with", "in cells"}, {"cells", "of"}});
  }
  if (const BenchRows rows = rowsOf(result, "front", own); !rows.empty()) {
    text += "<h3>Pareto fronts</h3>\n" + htmlTable(rows, {{"plot", "plot"},
                                                          {"series", "who"},
                                                          {"choice", "choice"},
                                                          {"cost_of", "cost of"},
                                                          {"cost", "cost", 4},
                                                          {"error_of", "error of"},
                                                          {"error", "error", 5}});
  }
  return text + fmt::format("<details><summary>All {} cells</summary>\n{}</details>\n</section>\n", cells.size(),
                            htmlTable(cells, columnsOf(cells)));
}

}  // namespace

std::string errorReport(const BenchResult& result) {
  std::string text = headOf(result) + targetSection(result);
  for (const Study& study : studies()) text += studySection(result, study);
  return text +
         fmt::format(
             "<section>\n<h2>Machines</h2>\n{}</section>\n</main>\n</body>\n</html>\n",
             htmlTable(
                 rowsOf(result, "shard"),
                 {{"shard", "shard"}, {"shards", "of"}, {"machine", "machine"}, {"vulkan_device", "Vulkan device"}}));
}

}  // namespace palpate
