// SPDX-License-Identifier: Apache-2.0
// Small plots to the letter. They are 560 x 220, and what is drawn into lies from 64 to 548 and from 14 to 176.
#include "apps/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace svg_plot_test {

using ::testing::HasSubstr;

// The last number, 1000, is 4 x 0.64 x 12 = 30.72 wide, so the axis ends 15.36 before the edge: at 544.64. Three
// decades of 160.21 each; of two decades of counts and 0.3 more, which are 162 high, 9 take 88.3 and 10 take 91.6.
TEST(SvgPlot, HistogramToTheLetter) {
  LogHistogram h;
  h.low = 1;
  h.ratio = 10;
  h.counts = {9, 0, 100};
  EXPECT_EQ(histogramSvg(h, "edits <by> time", "ms", "edits"),
            R"(<svg class="plot" viewBox="0 0 560 220" role="img" aria-label="edits &lt;by&gt; time">
<line class="grid" x1="64.0" y1="154.9" x2="544.6" y2="154.9"/>
<text x="58.0" y="158.9" text-anchor="end">1</text>
<line class="grid" x1="64.0" y1="84.4" x2="544.6" y2="84.4"/>
<text x="58.0" y="88.4" text-anchor="end">10</text>
<line class="grid" x1="64.0" y1="14.0" x2="544.6" y2="14.0"/>
<text x="58.0" y="18.0" text-anchor="end">100</text>
<line class="axis" x1="64.0" y1="176.0" x2="64.0" y2="181.0"/>
<text x="64.0" y="194.0" text-anchor="middle">1</text>
<line class="axis" x1="224.2" y1="176.0" x2="224.2" y2="181.0"/>
<text x="224.2" y="194.0" text-anchor="middle">10</text>
<line class="axis" x1="384.4" y1="176.0" x2="384.4" y2="181.0"/>
<text x="384.4" y="194.0" text-anchor="middle">100</text>
<line class="axis" x1="544.6" y1="176.0" x2="544.6" y2="181.0"/>
<text x="544.6" y="194.0" text-anchor="middle">1000</text>
<rect class="bar" x="64.5" y="87.7" width="159.2" height="88.3"><title>1 to 10 ms: 9 edits</title></rect>
<rect class="bar" x="384.9" y="14.0" width="159.2" height="162.0"><title>100 to 1000 ms: 100 edits</title></rect>
<line class="axis" x1="64.0" y1="176.0" x2="544.6" y2="176.0"/>
<text x="304.3" y="214.0" text-anchor="middle">edits &lt;by&gt; time</text>
</svg>
)");
}

// How many words of a plot, 560 wide, are not wholly in it. A digit of DejaVu Sans is 0.64 times its size wide, a plus
// 0.84; a tenth of a pixel is rounding.
int cutOff(const std::string& svg) {
  static const std::regex kText("<text x=\"([-0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"(middle|end)\">([^<]*)<");
  int cut = 0;
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kText); it != std::sregex_iterator(); ++it) {
    const std::string words = (*it)[3];
    const auto pluses = static_cast<double>(std::count(words.begin(), words.end(), '+'));
    const double width = 12 * (0.64 * static_cast<double>(words.size()) + 0.2 * pluses);
    const double right = std::stod((*it)[1]) + ((*it)[2] == "middle" ? width / 2 : 0);
    if (right - width < -0.1 || right > 560.1) ++cut;
  }
  return cut;
}

// Times from a nanosecond to a day, in any unit; counts to 10^15; curves of any height.
TEST(SvgPlot, NumbersAtTheAxesAreWhole) {
  std::mt19937_64 random(5);
  const auto between = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  for (int round = 0; round < 1000; ++round) {
    LogHistogram h;
    h.low = std::pow(10.0, between(-9, 8));
    h.ratio = 10;
    h.counts.assign(static_cast<std::size_t>(between(1, 6)), 1);
    h.counts.back() = static_cast<std::size_t>(std::pow(10.0, between(0, 15)));
    EXPECT_EQ(cutOff(histogramSvg(h, "", "us", "ticks")), 0) << h.low << ", " << h.counts.back();
    const double height = std::pow(10.0, between(-12, 12)) * (between(0, 1) == 0 ? -1.234 : 5.678);
    const double begin_s = between(0, 100) * 1234.5;
    EXPECT_EQ(cutOff(curveSvg({{begin_s, begin_s + between(1, 1000)}, {{0, height}}}, "")), 0) << height;
  }
}

// One tick in each of 1000 classes: counts reach to a decade all the same, and a bar is never thinner than half a
// pixel.
TEST(SvgPlot, ThinBarsAreStillDrawn) {
  LogHistogram h;
  h.low = 1;
  h.ratio = std::pow(10.0, 1e-3);
  h.counts.assign(1000, 1);
  const std::string svg = histogramSvg(h, "", "us", "ticks");
  // 0.3 of 1.3 in all: 37.4 of 162.
  EXPECT_THAT(svg, HasSubstr("<rect class=\"bar\" x=\"64.5\" y=\"138.6\" width=\"0.5\" height=\"37.4\">"));
}

// From -1 to 3 over 10 s to 20 s; a gap is left out.
TEST(SvgPlot, CurveToTheLetter) {
  const PlotTable table = {{10, 12, 15, 20}, {{-1, NAN, 3, 1}, {9, 9, 9, 9}}};
  EXPECT_EQ(curveSvg(table, "force & time"),
            R"(<svg class="plot" viewBox="0 0 560 220" role="img" aria-label="force &amp; time">
<polyline class="curve" points="64.0,176.0 306.0,14.0 548.0,95.0 "/>
<line class="axis" x1="64.0" y1="176.0" x2="548.0" y2="176.0"/>
<text x="58.0" y="22.0" text-anchor="end">3</text>
<text x="58.0" y="176.0" text-anchor="end">-1</text>
<text x="64.0" y="196.0" text-anchor="middle">10</text>
<text x="548.0" y="196.0" text-anchor="end">20 s</text>
<text x="306.0" y="214.0" text-anchor="middle">force &amp; time</text>
</svg>
)");
}

// Zero is always on the axis; what is zero throughout lies at the bottom, and one point at the left.
TEST(SvgPlot, CurveThatDoesNotChange) {
  EXPECT_THAT(curveSvg({{0, 2}, {{5, 5}}}, ""), HasSubstr("points=\"64.0,14.0 548.0,14.0 \""));
  EXPECT_THAT(curveSvg({{0, 2}, {{0, 0}}}, ""), HasSubstr("points=\"64.0,176.0 548.0,176.0 \""));
  EXPECT_THAT(curveSvg({{3}, {{5}}}, ""), HasSubstr("points=\"64.0,14.0 \""));
  PlotTable empty;
  empty.series.resize(1);
  EXPECT_THAT(curveSvg(empty, ""), HasSubstr("points=\"\""));
  EXPECT_THAT(curveSvg(empty, ""), HasSubstr(">1 s</text>"));
}

}  // namespace svg_plot_test
}  // namespace palpate
