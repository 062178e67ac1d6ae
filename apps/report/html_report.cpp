// SPDX-License-Identifier: Apache-2.0
#include "apps/report/html_report.hpp"

#include <fmt/format.h>

#include "apps/report/html_data.hpp"
#include "apps/report/html_tables.hpp"
#include "apps/report/html_text.hpp"
#include "apps/report/page_files.hpp"
#include "apps/report/plot_data.hpp"
#include "apps/report/summary.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/report/words.hpp"
#include "base/atomic_file.hpp"

namespace palpate {
namespace {

constexpr int kClassesPerDecade = 10;

std::string head(const TouchRun& run) {
  return fmt::format(
      R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>Palpate: touching {}</title>
<style>
{}
{}</style>
</head>
<body>
<main>
)",
      escapeHtml(run.volume.name), kDygraphsCss, kReportCss);
}

std::string header(const TouchRun& run, const RunFigures& figures) {
  return fmt::format(
      R"(<header>
<p class="kind">Palpate touch report</p>
<h1>{}</h1>
<p class="verdict">{}</p>
</header>
)",
      escapeHtml(run.volume.name), escapeHtml(verdict(run, figures)));
}

std::string picture(std::string_view view_png) {
  if (view_png.empty()) return "";
  return fmt::format(
      R"(<section id="picture">
<img alt="The surface that was touched, the tool's path and the forces" src="data:image/png;base64,{}">
</section>
)",
      base64(view_png));
}

std::string plotSection(const std::vector<ReportPlot>& plots, bool simulated_clock) {
  std::string out =
      R"(<section id="plots">
<h2>Over time</h2>
<p class="hint script">Drag to zoom in all plots, double-click to see everything again.</p>
)";
  for (const ReportPlot& plot : plots) {
    out += fmt::format(
        R"(<h3>{}<span class="legend script" id="{}-legend"></span></h3>
<div class="graph script" id="{}"></div>
<noscript>{}</noscript>
)",
        escapeHtml(plot.title), plot.id, plot.id,
        curveSvg({plot.table.time_s, {plot.table.series.back()}}, plot.title + " over time"));
  }
  if (simulated_clock)
    out +=
        "<p>The clock was simulated: ticks followed each other without waiting, "
        "so tick cost and wake-up lateness were not measured.</p>\n";
  return out + "</section>\n";
}

std::string histograms(const TouchRun& run) {
  if (run.scene.simulated_clock || run.records.empty()) return "";
  std::vector<double> cost_us, lateness_us;
  for (const TickRecord& r : run.records) {
    cost_us.push_back(r.tick_cost_ns * 1e-3);
    lateness_us.push_back(static_cast<double>(r.lateness_ns) * 1e-3);
  }
  std::string out = "<section id=\"histograms\">\n<h2>How often</h2>\n<div class=\"columns\">\n";
  for (const auto& [values, label] :
       {std::pair(&cost_us, "tick cost [us]"), std::pair(&lateness_us, "wake-up lateness [us]")}) {
    const LogHistogram h = logHistogram(*values, kClassesPerDecade);
    out += h.counts.empty() ? fmt::format("<p>Every {} is zero.</p>\n", label)
                            : "<div>" + histogramSvg(h, std::string("ticks by ") + label, "us", "ticks") + "</div>\n";
  }
  return out + "</div>\n</section>\n";
}

std::string scripts(const std::vector<ReportPlot>& plots, const TouchRun& run) {
  using Handler = nlohmann::ordered_json::error_handler_t;
  return fmt::format(
      "<script type=\"application/json\" id=\"data\">{}</script>\n<script>{}</script>\n<script>\n{}</script>\n",
      escapeScriptJson(plotsJson(plots, run).dump(-1, ' ', false, Handler::replace)), kDygraphsJs, kReportJs);
}

}  // namespace

std::string makeReport(const TouchRun& run, std::string_view view_png) {
  const RunFigures figures = figuresOf(run);
  const std::vector<ReportPlot> plots = makePlots(run);
  return head(run) + header(run, figures) + picture(view_png) + keyFigures(run, figures) + faultSection(run) +
         plotSection(plots, run.scene.simulated_clock) + histograms(run) + editSection(run) + workSection(run) +
         planSection(run) + parameterSection(run, makeSummary(run)) + machineSection(run) + repeatSection(run) +
         "</main>\n" + scripts(plots, run) + "</body>\n</html>\n";
}

void writeReport(const std::filesystem::path& file, const TouchRun& run, std::string_view view_png) {
  writeFileAtomically(file, makeReport(run, view_png));
}

}  // namespace palpate
