// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/log_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/report/html_text.hpp"
#include "apps/report/label_placer.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {
namespace {

constexpr double kPanelWidth = 460, kPanelHeight = 380;
constexpr double kLeft = 78, kRight = 16, kTop = 30, kBottom = 46;
constexpr double kTitle = 30, kLegendLine = 22;
constexpr double kInnerHeight = kPanelHeight - kTop - kBottom;
constexpr double kFontSize = 12;

// Okabe and Ito's colours, which people with any colour vision can tell apart, without the yellow.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#000000", "#56b4e9", "#e69f00"};

constexpr const char* kFormula = "#444";  // colour of the line of a formula
constexpr const char* kDashes = " stroke-dasharray=\"7 4\"";

bool drawable(const ChartPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0 && point.y > 0;
}

// Logarithmic axis over the values, with some air and at least one power of ten in it.
struct Axis {
  double low = 0, high = 1;  // decimal logarithms
  double length = 0;         // [pixel]
  [[nodiscard]] double share(double value) const { return (std::log10(value) - low) / (high - low); }
};

Axis axisOver(const ChartPanel& panel, double ChartPoint::*value, double length) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ChartSeries& series : panel.series) {
    for (const ChartPoint& point : series.points) {
      if (!drawable(point)) continue;
      low = std::min(low, std::log10(point.*value));
      high = std::max(high, std::log10(point.*value));
    }
  }
  if (low > high) return {0, 1, length};
  constexpr double kAir = 0.06;
  const double air = std::max(kAir * (high - low), 0.15);
  return {low - air, high + air, length};
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

std::string tickLabel(double value) {
  return fmt::format("{:g}", value);
}

// It ends so far from the panel's right edge that the label of its last tick, which may be at its very end, fits.
Axis acrossAxis(const ChartPanel& panel) {
  Axis axis = axisOver(panel, &ChartPoint::x, kPanelWidth - kLeft - kRight);
  const std::vector<double> ticks = ticksOf(axis);
  if (ticks.empty()) return axis;
  const double half = numberWidth(tickLabel(ticks.back()), kFontSize) / 2;
  if (kLeft + axis.length * axis.share(ticks.back()) + half > kPanelWidth) axis.length = kPanelWidth - kLeft - half;
  return axis;
}

std::string text(double x, double y, const char* anchor, const std::string& words, const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escapeHtml(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* color) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2, y2,
                     color);
}

// So that a series is known without its colour too: four shapes filled, the same empty, and four more.
std::string mark(double x, double y, std::size_t kind) {
  const char* color = kColors[kind % kColors.size()];
  const bool empty = kind / 4 % 3 == 1;
  const std::string fill = empty ? fmt::format("white\" stroke=\"{}\" stroke-width=\"1.6", color) : std::string(color);
  const auto path = [&](const char* words) {
    return fmt::format("<path d=\"M{:.1f} {:.1f}{}\" fill=\"{}\"/>\n", x, y, words, fill);
  };
  const auto strokes = [&](const char* words) {
    return fmt::format("<path d=\"M{:.1f} {:.1f}{}\" stroke=\"{}\" stroke-width=\"2\"/>\n", x, y, words, color);
  };
  switch (kind % 12) {
    case 0:
    case 4:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, empty ? 4 : 4.5, fill);
    case 1:
    case 5:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" height=\"8\" fill=\"{}\"/>\n", x - 4, y - 4,
                         fill);
    case 2:
    case 6:
      return path("m0 -5.5l5.2 9h-10.4z");
    case 3:
    case 7:
      return path("m0 -5l5 5l-5 5l-5 -5z");
    case 8:
      return path("m0 5.5l5.2 -9h-10.4z");
    case 9:
      return strokes("m-5 0h10m-5 -5v10");
    case 10:
      return strokes("m-4 -4l8 8m0 -8l-8 8");
    default:
      return path("m0 -5l5 3.6l-1.9 5.9h-6.2l-1.9 -5.9z");
  }
}

std::string ring(const Pixel& at) {
  return fmt::format("<ellipse cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"8\" ry=\"8\" fill=\"none\" stroke=\"#000\"/>\n", at.x,
                     at.y);
}

std::size_t kindOf(const std::string& name, const std::vector<std::string>& names) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::string axes(const ChartPanel& panel, const Axis& x, const Axis& y) {
  const double bottom = kTop + kInnerHeight;
  std::string out;
  for (const double value : ticksOf(x)) {
    const double at = kLeft + x.length * x.share(value);
    out += line(at, kTop, at, bottom, "#e4e4e4") + text(at, bottom + 16, "middle", tickLabel(value));
  }
  for (const double value : ticksOf(y)) {
    const double at = bottom - y.length * y.share(value);
    out += line(kLeft, at, kLeft + x.length, at, "#e4e4e4") + text(kLeft - 6, at + 4, "end", tickLabel(value));
  }
  out += line(kLeft, bottom, kLeft + x.length, bottom, "#444") + line(kLeft, kTop, kLeft, bottom, "#444");
  out += text(kLeft + x.length / 2, kTop - 10, "middle", panel.title, " font-weight=\"bold\"");
  out += text(kLeft + x.length / 2, bottom + 36, "middle", panel.x_label);
  const double middle = kTop + kInnerHeight / 2;
  return out + text(14, middle, "middle", panel.y_label, fmt::format(" transform=\"rotate(-90 14 {:.1f})\"", middle));
}

Pixel placeOf(const ChartPoint& point, const Axis& x, const Axis& y) {
  return {kLeft + x.length * x.share(point.x), kTop + y.length * (1 - y.share(point.y))};
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
  const bool dashed = series.look == SeriesLook::kDashed;
  for (const Pixel& at : placesOf(series, x, y)) {
    polyline += fmt::format("{:.1f},{:.1f} ", at.x, at.y);
    if (marks == ChartMarks::kPoints && !dashed) points += mark(at.x, at.y, kind);
  }
  if (series.look == SeriesLook::kMarksAlone) return points;
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", polyline,
                     dashed ? kFormula : kColors[kind % kColors.size()], marks == ChartMarks::kLine ? "1.8" : "0.8",
                     dashed ? kDashes : "") +
         points;
}

// Rings around the choices that no other one beats, and the steps between them.
std::string frontSvg(const ChartPanel& panel, const Axis& x, const Axis& y) {
  std::vector<Pixel> front;
  for (const ChartSeries& series : panel.series) {
    for (const ChartPoint& point : series.points) {
      if (point.on_front && drawable(point)) front.push_back(placeOf(point, x, y));
    }
  }
  if (front.empty()) return "";
  std::sort(front.begin(), front.end(), [](const Pixel& a, const Pixel& b) { return a.x < b.x; });
  std::string rings, steps = fmt::format("{:.1f},{:.1f} ", front.front().x, kTop);
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (i > 0) steps += fmt::format("{:.1f},{:.1f} ", front[i].x, front[i - 1].y);
    steps += fmt::format("{:.1f},{:.1f} ", front[i].x, front[i].y);
    rings += ring(front[i]);
  }
  steps += fmt::format("{:.1f},{:.1f}", kLeft + x.length, front.back().y);
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#000\" stroke-width=\"1\"/>\n", steps) + rings;
}

// Beside their marks, clear of each other, of all marks and, where there is room, of the lines; inside the axes.
std::string labelsSvg(const ChartPanel& panel, const std::vector<std::string>& names, const Axis& x, const Axis& y) {
  constexpr double kSize = 10, kLetter = 6.4, kMark = 5, kRing = 8;  // [pixel]; no letter of the labels is wider
  LabelPlacer placer(kLeft + x.length, kTop + kInnerHeight);
  placer.avoid({0, 0, kLeft, kTop + kInnerHeight});
  for (const ChartSeries& series : panel.series) {
    if (series.look != SeriesLook::kMarksAlone) placer.avoidLine(placesOf(series, x, y));
    if (series.look == SeriesLook::kDashed) continue;
    for (const ChartPoint& point : series.points) {
      if (!drawable(point)) continue;
      const Pixel at = placeOf(point, x, y);
      const double reach = point.on_front ? kRing : kMark;
      placer.avoid({at.x - reach, at.y - reach, at.x + reach, at.y + reach});
    }
  }
  std::string out;
  for (const ChartSeries& series : panel.series) {
    const char* color = kColors[kindOf(series.name, names) % kColors.size()];
    for (const ChartPoint& point : series.points) {
      if (!drawable(point) || point.label.empty()) continue;
      const LabelBox box = placer.place(placeOf(point, x, y), (point.on_front ? kRing : kMark) + 3,
                                        kLetter * static_cast<double>(point.label.size()), kSize);
      out += text(box.left, box.bottom - 0.2 * kSize, "start", point.label,
                  fmt::format(" font-size=\"{}\" fill=\"{}\"", kSize, color));
    }
  }
  return out;
}

std::string dashes(const Pixel& at) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}h16\" stroke=\"{}\" stroke-width=\"1.4\"{}/>\n", at.x - 9, at.y, kFormula,
                     kDashes);
}

struct Legend {
  std::string svg;
  double bottom = 0;  // [pixel]
};

// A mark or a dash for each name, in as many lines as they need.
Legend legendOf(const std::vector<ChartPanel>& panels, const std::vector<std::string>& names, double width,
                double top) {
  Legend legend{"", top + kLegendLine};
  double x = kLeft;
  const auto entry = [&](const std::string& words, const auto& sign) {
    const double long_px = 34 + 7.5 * static_cast<double>(words.size());
    if (x > kLeft && x + long_px > width) {
      x = kLeft;
      legend.bottom += kLegendLine;
    }
    legend.svg += sign(Pixel{x, legend.bottom - 12}) + text(x + 10, legend.bottom - 8, "start", words);
    x += long_px;
  };
  std::vector<std::string> formulas;
  bool front = false;
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      if (series.look == SeriesLook::kDashed) formulas.push_back(series.name);
      front =
          front || std::any_of(series.points.begin(), series.points.end(), [](const auto& p) { return p.on_front; });
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool dashed = std::find(formulas.begin(), formulas.end(), names[i]) != formulas.end();
    entry(names[i], [&](const Pixel& at) { return dashed ? dashes(at) : mark(at.x, at.y, i); });
  }
  if (front) entry("Pareto front", ring);
  return legend;
}

// A chart without the frame of a file, and what it takes [pixel].
struct ChartSvg {
  std::string text;
  double width = 0, height = 0;
};

ChartSvg chartSvg(const LogChart& chart) {
  const std::vector<ChartPanel>& panels = chart.panels;
  std::vector<std::string> names;
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      if (kindOf(series.name, names) == names.size()) names.push_back(series.name);
    }
  }
  const std::size_t columns = chart.columns == 0 ? panels.size() : std::min(chart.columns, panels.size());
  const std::size_t across = std::max<std::size_t>(columns, 1);
  const std::size_t down = std::max<std::size_t>((panels.size() + across - 1) / across, 1);
  const double width = kPanelWidth * static_cast<double>(across);
  const Legend legend = legendOf(panels, names, width, kTitle + kPanelHeight * static_cast<double>(down));
  std::string out = text(width / 2, 20, "middle", chart.title, " font-size=\"14\" font-weight=\"bold\"");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Axis x = acrossAxis(panels[i]), y = axisOver(panels[i], &ChartPoint::y, kInnerHeight);
    const std::size_t row = i / across, column = i % across;
    out += fmt::format("<g transform=\"translate({} {})\">\n", kPanelWidth * static_cast<double>(column),
                       kTitle + kPanelHeight * static_cast<double>(row));
    out += axes(panels[i], x, y);
    for (const ChartSeries& series : panels[i].series) {
      out += seriesSvg(series, kindOf(series.name, names), x, y, chart.marks);
    }
    out += frontSvg(panels[i], x, y);
    if (chart.marks == ChartMarks::kPoints) out += labelsSvg(panels[i], names, x, y);
    out += "</g>\n";
  }
  return {out + legend.svg, width, legend.bottom};
}

}  // namespace

void addPoint(std::vector<ChartPanel>& panels, ChartPanel panel, const std::string& series, ChartPoint point) {
  auto at = std::find_if(panels.begin(), panels.end(), [&](const ChartPanel& p) { return p.title == panel.title; });
  if (at == panels.end()) at = panels.insert(at, std::move(panel));
  auto line = std::find_if(at->series.begin(), at->series.end(), [&](const auto& s) { return s.name == series; });
  if (line == at->series.end()) line = at->series.insert(line, {series, {}});
  line->points.push_back(std::move(point));
}

LogCharts onlyPanels(LogCharts charts, const std::vector<std::string>& titles) {
  std::vector<std::string> known;
  for (LogChart& chart : charts) {
    for (const ChartPanel& panel : chart.panels) known.push_back(panel.title);
    std::erase_if(chart.panels,
                  [&](const ChartPanel& panel) { return std::ranges::find(titles, panel.title) == titles.end(); });
  }
  std::erase_if(charts, [](const LogChart& chart) { return chart.panels.empty(); });
  for (const std::string& title : titles) {
    if (std::ranges::find(known, title) != known.end()) continue;
    refuse(title, "no panel of the chart has this title",
           withDidYouMean(title, known, fmt::format("the titles are: {}", fmt::join(known, "; "))));
  }
  return charts;
}

std::string logChartSvg(const LogCharts& charts) {
  double width = kPanelWidth, height = 0;
  std::string out;
  for (const LogChart& chart : charts) {
    const ChartSvg svg = chartSvg(chart);
    out += fmt::format("<g transform=\"translate(0 {})\">\n{}</g>\n", height, svg.text);
    width = std::max(width, svg.width);
    height += svg.height;
  }
  return fmt::format(
             R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" font-family="DejaVu Sans, sans-serif" font-size="{2}">
<rect width="100%" height="100%" fill="white"/>
)",
             width, std::max(height, 1.0), kFontSize) +
         out + "</svg>\n";
}

}  // namespace palpate
