// SPDX-License-Identifier: Apache-2.0
#include "apps/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/report/html_text.hpp"
#include "apps/report/words.hpp"

namespace palpate {
namespace {

constexpr double kWidth = 560, kHeight = 220, kLeft = 64, kRight = 12, kTop = 14, kBottom = 44;
constexpr double kInnerWidth = kWidth - kLeft - kRight, kInnerHeight = kHeight - kTop - kBottom;

std::string open(const std::string& label) {
  return fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, kHeight,
                     escapeHtml(label));
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escapeHtml(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", style, x1, y1,
                     x2, y2);
}

// Height of a bar. Even one tick is visible.
double barHeight(std::size_t count, double decades) {
  return count == 0 ? 0 : (std::log10(static_cast<double>(count)) + 0.3) / (decades + 0.3) * kInnerHeight;
}

std::string countAxis(double decades) {
  std::string out;
  for (int decade = 0; decade <= static_cast<int>(decades); ++decade) {
    const auto count = static_cast<std::size_t>(std::llround(std::pow(10.0, decade)));
    const double y = kTop + kInnerHeight - barHeight(count, decades);
    out += line(kLeft, y, kWidth - kRight, y, "grid") + text(kLeft - 6, y + 4, "end", std::to_string(count));
  }
  return out;
}

std::string timeAxis(const LogHistogram& h) {
  const double decades = std::log10(h.edge(h.counts.size()) / h.low);
  std::string out;
  for (int decade = 0; decade <= static_cast<int>(std::lround(decades)); ++decade) {
    const double x = kLeft + kInnerWidth * decade / decades;
    out += line(x, kTop + kInnerHeight, x, kTop + kInnerHeight + 5, "axis");
    out += text(x, kTop + kInnerHeight + 18, "middle", fmt::format("{:g}", h.low * std::pow(10.0, decade)));
  }
  return out;
}

struct Range {
  double low = 0, high = 0;
};

Range rangeOf(const std::vector<double>& v) {
  Range range;
  for (const double x : v) {
    if (std::isnan(x)) continue;
    range.low = std::min(range.low, x);
    range.high = std::max(range.high, x);
  }
  if (range.high <= range.low) range.high = range.low + 1;
  return range;
}

}  // namespace

std::string histogramSvg(const LogHistogram& h, const std::string& label, const char* unit, const char* things) {
  std::size_t most = 1;
  for (const std::size_t count : h.counts) most = std::max(most, count);
  const double decades = std::max(1.0, std::log10(static_cast<double>(most)));
  std::string out = open(label) + countAxis(decades) + timeAxis(h);
  const double width = kInnerWidth / static_cast<double>(h.counts.size());
  for (std::size_t i = 0; i < h.counts.size(); ++i) {
    if (h.counts[i] == 0) continue;
    const double height = barHeight(h.counts[i], decades);
    out += fmt::format(
        "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{} to {} {}: "
        "{} {}</title></rect>\n",
        kLeft + width * static_cast<double>(i) + 0.5, kTop + kInnerHeight - height, std::max(width - 1, 0.5), height,
        shortNumber(h.edge(i)), shortNumber(h.edge(i + 1)), unit, h.counts[i], things);
  }
  out += line(kLeft, kTop + kInnerHeight, kWidth - kRight, kTop + kInnerHeight, "axis");
  return out + text(kLeft + kInnerWidth / 2, kHeight - 6, "middle", label) + "</svg>\n";
}

std::string curveSvg(const PlotTable& table, const std::string& label) {
  std::string out = open(label);
  const Range y = rangeOf(table.series.front());
  const double begin_s = table.time_s.empty() ? 0 : table.time_s.front();
  const double end_s = table.time_s.empty() ? 1 : std::max(table.time_s.back(), begin_s + 1e-9);
  std::string points;
  for (std::size_t i = 0; i < table.time_s.size(); ++i) {
    if (std::isnan(table.series.front()[i])) continue;
    points += fmt::format("{:.1f},{:.1f} ", kLeft + kInnerWidth * (table.time_s[i] - begin_s) / (end_s - begin_s),
                          kTop + kInnerHeight * (y.high - table.series.front()[i]) / (y.high - y.low));
  }
  out += "<polyline class=\"curve\" points=\"" + points + "\"/>\n";
  out += line(kLeft, kTop + kInnerHeight, kWidth - kRight, kTop + kInnerHeight, "axis");
  out += text(kLeft - 6, kTop + 8, "end", shortNumber(y.high)) +
         text(kLeft - 6, kTop + kInnerHeight, "end", shortNumber(y.low));
  out += text(kLeft, kHeight - 24, "middle", shortNumber(begin_s)) +
         text(kWidth - kRight, kHeight - 24, "end", shortNumber(end_s) + " s");
  return out + text(kLeft + kInnerWidth / 2, kHeight - 6, "middle", label) + "</svg>\n";
}

}  // namespace palpate
