// SPDX-License-Identifier: Apache-2.0
// Small plots to the letter. They are 560 x 220, and what is drawn into lies from 64 to 548 and from 14 to 176.
#include "apps/report/svg_plot.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace svg_plot_test {

using ::testing::HasSubstr;

// Three decades of 161.33 each; of two decades of counts and 0.3 more, which are 162 high, 9 take 88.3 and 10
// take 91.6.
TEST(SvgPlot, HistogramToTheLetter) {
  LogHistogram h;
  h.low = 1;
  h.ratio = 10;
  h.counts = {9, 0, 100};
  EXPECT_EQ(histogramSvg(h, "edits <by> time", "ms", "edits"),
            R"(<svg class="plot" viewBox="0 0 560 220" role="img" aria-label="edits &lt;by&gt; time">
<line class="grid" x1="64.0" y1="154.9" x2="548.0" y2="154.9"/>
<text x="58.0" y="158.9" text-anchor="end">1</text>
<line class="grid" x1="64.0" y1="84.4" x2="548.0" y2="84.4"/>
<text x="58.0" y="88.4" text-anchor="end">10</text>
<line class="grid" x1="64.0" y1="14.0" x2="548.0" y2="14.0"/>
<text x="58.0" y="18.0" text-anchor="end">100</text>
<line class="axis" x1="64.0" y1="176.0" x2="64.0" y2="181.0"/>
<text x="64.0" y="194.0" text-anchor="middle">1</text>
<line class="axis" x1="225.3" y1="176.0" x2="225.3" y2="181.0"/>
<text x="225.3" y="194.0" text-anchor="middle">10</text>
<line class="axis" x1="386.7" y1="176.0" x2="386.7" y2="181.0"/>
<text x="386.7" y="194.0" text-anchor="middle">100</text>
<line class="axis" x1="548.0" y1="176.0" x2="548.0" y2="181.0"/>
<text x="548.0" y="194.0" text-anchor="middle">1000</text>
<rect class="bar" x="64.5" y="87.7" width="160.3" height="88.3"><title>1 to 10 ms: 9 edits</title></rect>
<rect class="bar" x="387.2" y="14.0" width="160.3" height="162.0"><title>100 to 1000 ms: 100 edits</title></rect>
<line class="axis" x1="64.0" y1="176.0" x2="548.0" y2="176.0"/>
<text x="306.0" y="214.0" text-anchor="middle">edits &lt;by&gt; time</text>
</svg>
)");
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
