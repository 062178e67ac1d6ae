// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/log_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "apps/report/html_text.hpp"
#include "apps/report/label_placer.hpp"

namespace palpate {
namespace {

constexpr double kPanelWidth = 460, kPanelHeight = 380;
constexpr double kLeft = 78, kRight = 16, kTop = 30, kBottom = 46;
constexpr double kTitle = 30, kLegendLine = 22;
constexpr double kInnerWidth = kPanelWidth - kLeft - kRight, kInnerHeight = kPanelHeight - kTop - kBottom;

// Okabe and Ito's colours, which people with any colour vision can tell apart, without the yellow.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#000000", "#56b4e9", "#e69f00"};

bool drawable(const ChartPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0 && point.y > 0;
}

// Logarithmic axis over the values, with some air and at least one power of ten in it.
struct Axis {
  double low = 0, high = 1;  // decimal logarithms
  [[nodiscard]] double share(double value) const { return (std::log10(value) - low) / (high - low); }
};

Axis axisOver(const ChartPanel& panel, double ChartPoint::*value) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ChartSeries& series : panel.series) {
    for (const ChartPoint& point : series.points) {
      if (!drawable(point)) continue;
      low = std::min(low, std::log10(point.*value));
      high = std::max(high, std::log10(point.*value));
    }
  }
  if (low > high) return {0, 1};
  constexpr double kAir = 0.06;
  const double air = std::max(kAir * (high - low), 0.15);
  return {low - air, high + air};
}

// 1, 2, 5 in every decade, or the decades alone where there are many.
std::vector<double> ticksOf(const Axis& axis) {
  std::vector<double> ticks;
  constexpr double kManyDecades = 2.5;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= static_cast<int>(std::ceil(axis.high));
       ++decade) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (step > 1 && axis.high - axis.low > kManyDecades) continue;
      const double value = step * std::pow(10.0, decade);
      if (std::log10(value) >= axis.low && std::log10(value) <= axis.high) ticks.push_back(value);
    }
  }
  return ticks;
}

std::string text(double x, double y, const char* anchor, const std::string& words, const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escapeHtml(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* color) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2, y2,
                     color);
}

// Circle, square, triangle, diamond: so that a series is known without its colour too.
std::string mark(double x, double y, std::size_t kind) {
  const char* color = kColors[kind % kColors.size()];
  switch (kind % 4) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" fill=\"{}\"/>\n", x, y, color);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" height=\"8\" fill=\"{}\"/>\n", x - 4, y - 4,
                         color);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l5.2 9h-10.4z\" fill=\"{}\"/>\n", x, y - 5.5, color);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l5 5l-5 5l-5 -5z\" fill=\"{}\"/>\n", x, y - 5, color);
  }
}

std::size_t kindOf(const std::string& name, const std::vector<std::string>& names) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::string axes(const ChartPanel& panel, const Axis& x, const Axis& y) {
  const double bottom = kTop + kInnerHeight;
  std::string out;
  for (const double value : ticksOf(x)) {
    const double at = kLeft + kInnerWidth * x.share(value);
    out += line(at, kTop, at, bottom, "#e4e4e4") + text(at, bottom + 16, "middle", fmt::format("{:g}", value));
  }
  for (const double value : ticksOf(y)) {
    const double at = bottom - kInnerHeight * y.share(value);
    out += line(kLeft, at, kLeft + kInnerWidth, at, "#e4e4e4") +
           text(kLeft - 6, at + 4, "end", fmt::format("{:g}", value));
  }
  out += line(kLeft, bottom, kLeft + kInnerWidth, bottom, "#444") + line(kLeft, kTop, kLeft, bottom, "#444");
  out += text(kLeft + kInnerWidth / 2, kTop - 10, "middle", panel.title, " font-weight=\"bold\"");
  out += text(kLeft + kInnerWidth / 2, bottom + 36, "middle", panel.x_label);
  const double middle = kTop + kInnerHeight / 2;
  return out + text(14, middle, "middle", panel.y_label, fmt::format(" transform=\"rotate(-90 14 {:.1f})\"", middle));
}

Pixel placeOf(const ChartPoint& point, const Axis& x, const Axis& y) {
  return {kLeft + kInnerWidth * x.share(point.x), kTop + kInnerHeight * (1 - y.share(point.y))};
}

std::vector<Pixel> placesOf(const ChartSeries& series, const Axis& x, const Axis& y) {
  std::vector<Pixel> places;
  for (const ChartPoint& point : series.points) {
    if (drawable(point)) places.push_back(placeOf(point, x, y));
  }
  return places;
}

std::string seriesSvg(const ChartSeries& series, std::size_t kind, const Axis& x, const Axis& y, ChartMarks marks) {
  std::string polyline, points;
  for (const Pixel& at : placesOf(series, x, y)) {
    polyline += fmt::format("{:.1f},{:.1f} ", at.x, at.y);
    if (marks == ChartMarks::kPoints) points += mark(at.x, at.y, kind);
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n", polyline,
                     kColors[kind % kColors.size()], marks == ChartMarks::kLine ? "1.8" : "0.8") +
         points;
}

// Beside their marks, clear of each other, of all marks and, where there is room, of the lines; inside the axes.
std::string labelsSvg(const ChartPanel& panel, const std::vector<std::string>& names, const Axis& x, const Axis& y) {
  constexpr double kSize = 10, kLetter = 6.4, kMark = 5;  // [pixel]; no letter of the labels is wider
  LabelPlacer placer(kLeft + kInnerWidth, kTop + kInnerHeight);
  placer.avoid({0, 0, kLeft, kTop + kInnerHeight});
  for (const ChartSeries& series : panel.series) {
    const std::vector<Pixel> places = placesOf(series, x, y);
    placer.avoidLine(places);
    for (const Pixel& at : places) placer.avoid({at.x - kMark, at.y - kMark, at.x + kMark, at.y + kMark});
  }
  std::string out;
  for (const ChartSeries& series : panel.series) {
    const char* color = kColors[kindOf(series.name, names) % kColors.size()];
    for (const ChartPoint& point : series.points) {
      if (!drawable(point) || point.label.empty()) continue;
      const LabelBox box =
          placer.place(placeOf(point, x, y), kMark + 3, kLetter * static_cast<double>(point.label.size()), kSize);
      out += text(box.left, box.bottom - 0.2 * kSize, "start", point.label,
                  fmt::format(" font-size=\"{}\" fill=\"{}\"", kSize, color));
    }
  }
  return out;
}

}  // namespace

void addPoint(std::vector<ChartPanel>& panels, const ChartPanel& panel, const std::string& series, ChartPoint point) {
  auto at = std::find_if(panels.begin(), panels.end(), [&](const ChartPanel& p) { return p.title == panel.title; });
  if (at == panels.end()) at = panels.insert(at, panel);
  auto line = std::find_if(at->series.begin(), at->series.end(), [&](const auto& s) { return s.name == series; });
  if (line == at->series.end()) line = at->series.insert(line, {series, {}});
  line->points.push_back(std::move(point));
}

std::string logChartSvg(const std::string& title, const std::vector<ChartPanel>& panels, ChartMarks marks) {
  std::vector<std::string> names;
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      if (kindOf(series.name, names) == names.size()) names.push_back(series.name);
    }
  }
  const double width = kPanelWidth * static_cast<double>(std::max<std::size_t>(panels.size(), 1));
  const double height = kTitle + kPanelHeight + kLegendLine;
  std::string out = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" font-family="DejaVu Sans, sans-serif" font-size="12">
<rect width="100%" height="100%" fill="white"/>
)",
      width, height);
  out += text(width / 2, 20, "middle", title, " font-size=\"14\" font-weight=\"bold\"");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Axis x = axisOver(panels[i], &ChartPoint::x), y = axisOver(panels[i], &ChartPoint::y);
    out += fmt::format("<g transform=\"translate({} {})\">\n", kPanelWidth * static_cast<double>(i), kTitle);
    out += axes(panels[i], x, y);
    for (const ChartSeries& series : panels[i].series) {
      out += seriesSvg(series, kindOf(series.name, names), x, y, marks);
    }
    if (marks == ChartMarks::kPoints) out += labelsSvg(panels[i], names, x, y);
    out += "</g>\n";
  }
  double x = kLeft;
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += mark(x, height - 12, i) + text(x + 10, height - 8, "start", names[i]);
    x += 34 + 7.5 * static_cast<double>(names[i].size());
  }
  return out + "</svg>\n";
}

}  // namespace palpate
