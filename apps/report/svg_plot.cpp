// SPDX-License-Identifier: Apache-2.0
#include "apps/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/report/html_text.hpp"
#include "apps/report/label_placer.hpp"
#include "apps/report/words.hpp"

namespace palpate {
namespace {

constexpr double kWidth = 560, kHeight = 220, kTop = 14, kBottom = 44;
constexpr double kInnerHeight = kHeight - kTop - kBottom;
constexpr double kLeastLeft = 64, kLeastRight = 12, kGap = 6;  // gap: between a label and the axis
constexpr double kLabelSize = 12;                              // report.css

// What is drawn into. Its margins hold the labels of its axes, however long they are.
struct Frame {
  double left = kLeastLeft, right = kWidth - kLeastRight;
  [[nodiscard]] double width() const { return right - left; }
};

Frame frameFor(const std::vector<std::string>& beside, const std::string& first_below, const std::string& last_below) {
  Frame frame;
  for (const std::string& label : beside) frame.left = std::max(frame.left, numberWidth(label, kLabelSize) + kGap);
  frame.left = std::max(frame.left, numberWidth(first_below, kLabelSize) / 2);
  frame.right = std::min(frame.right, kWidth - numberWidth(last_below, kLabelSize) / 2);
  return frame;
}

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

std::vector<std::size_t> countLabels(double decades) {
  std::vector<std::size_t> counts;
  for (int decade = 0; decade <= static_cast<int>(decades); ++decade)
    counts.push_back(static_cast<std::size_t>(std::llround(std::pow(10.0, decade))));
  return counts;
}

std::string countAxis(double decades, const Frame& frame) {
  std::string out;
  for (const std::size_t count : countLabels(decades)) {
    const double y = kTop + kInnerHeight - barHeight(count, decades);
    out += line(frame.left, y, frame.right, y, "grid") + text(frame.left - kGap, y + 4, "end", std::to_string(count));
  }
  return out;
}

double decadesOf(const LogHistogram& h) {
  return std::log10(h.edge(h.counts.size()) / h.low);
}

std::string timeLabel(const LogHistogram& h, int decade) {
  return fmt::format("{:g}", h.low * std::pow(10.0, decade));
}

std::string timeAxis(const LogHistogram& h, const Frame& frame) {
  const double decades = decadesOf(h);
  std::string out;
  for (int decade = 0; decade <= static_cast<int>(std::lround(decades)); ++decade) {
    const double x = frame.left + frame.width() * decade / decades;
    out += line(x, kTop + kInnerHeight, x, kTop + kInnerHeight + 5, "axis");
    out += text(x, kTop + kInnerHeight + 18, "middle", timeLabel(h, decade));
  }
  return out;
}

Frame frameOf(const LogHistogram& h, double decades) {
  std::vector<std::string> counts;
  for (const std::size_t count : countLabels(decades)) counts.push_back(std::to_string(count));
  return frameFor(counts, timeLabel(h, 0), timeLabel(h, static_cast<int>(std::lround(decadesOf(h)))));
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
  const Frame frame = frameOf(h, decades);
  std::string out = open(label) + countAxis(decades, frame) + timeAxis(h, frame);
  const double width = frame.width() / static_cast<double>(h.counts.size());
  for (std::size_t i = 0; i < h.counts.size(); ++i) {
    if (h.counts[i] == 0) continue;
    const double height = barHeight(h.counts[i], decades);
    out += fmt::format(
        "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{} to {} {}: "
        "{} {}</title></rect>\n",
        frame.left + width * static_cast<double>(i) + 0.5, kTop + kInnerHeight - height, std::max(width - 1, 0.5),
        height, shortNumber(h.edge(i)), shortNumber(h.edge(i + 1)), unit, h.counts[i], things);
  }
  out += line(frame.left, kTop + kInnerHeight, frame.right, kTop + kInnerHeight, "axis");
  return out + text(frame.left + frame.width() / 2, kHeight - 6, "middle", label) + "</svg>\n";
}

std::string curveSvg(const PlotTable& table, const std::string& label) {
  std::string out = open(label);
  const Range y = rangeOf(table.series.front());
  const std::string high = shortNumber(y.high), low = shortNumber(y.low);
  const double begin_s = table.time_s.empty() ? 0 : table.time_s.front();
  const double end_s = table.time_s.empty() ? 1 : std::max(table.time_s.back(), begin_s + 1e-9);
  const std::string begin = shortNumber(begin_s);
  const Frame frame = frameFor({high, low}, begin, "");
  std::string points;
  for (std::size_t i = 0; i < table.time_s.size(); ++i) {
    if (std::isnan(table.series.front()[i])) continue;
    points +=
        fmt::format("{:.1f},{:.1f} ", frame.left + frame.width() * (table.time_s[i] - begin_s) / (end_s - begin_s),
                    kTop + kInnerHeight * (y.high - table.series.front()[i]) / (y.high - y.low));
  }
  out += "<polyline class=\"curve\" points=\"" + points + "\"/>\n";
  out += line(frame.left, kTop + kInnerHeight, frame.right, kTop + kInnerHeight, "axis");
  out += text(frame.left - kGap, kTop + 8, "end", high) + text(frame.left - kGap, kTop + kInnerHeight, "end", low);
  out += text(frame.left, kHeight - 24, "middle", begin) +
         text(frame.right, kHeight - 24, "end", shortNumber(end_s) + " s");
  return out + text(frame.left + frame.width() / 2, kHeight - 6, "middle", label) + "</svg>\n";
}

}  // namespace palpate
