// SPDX-License-Identifier: Apache-2.0
#include "apps/view/legend.hpp"

#include <fmt/format.h>

#include "apps/report/words.hpp"
#include "apps/view/panel.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kText = 14, kSample = 34, kGap = 26;  // [pixel] at scale 1

// The largest size up to `size` at which the words fit.
double fittingSize(Canvas& canvas, const std::string& words, double size, bool bold, double width) {
  const double needed = canvas.textWidth(words, size, bold);
  return needed > width ? size * width / needed : size;
}

// Draws a sample line and its name, and advances `x`.
void lineItem(Canvas& canvas, Pixel& at, double scale, const Color& color, double dash, const char* words) {
  canvas.polyline({{at.x, at.y - 5 * scale}, {at.x + kSample * scale, at.y - 5 * scale}}, color, 3 * scale,
                  dash * scale);
  at.x += (kSample + 8) * scale;
  at.x += canvas.text(at, words, kText * scale, kInk) + kGap * scale;
}

void markItem(Canvas& canvas, Pixel& at, double scale, const Color& fill, const Color& rim, const char* words) {
  canvas.disc({at.x + 6 * scale, at.y - 5 * scale}, 5 * scale, fill, rim);
  at.x += 18 * scale;
  at.x += canvas.text(at, words, kText * scale, kInk) + kGap * scale;
}

// The colours of the arrows, and the line that goes with each. Without a force there is neither.
void forceItems(Canvas& canvas, Pixel& at, double scale, const ForceArrows& forces) {
  if (forces.most_N <= 0) {
    at.x += canvas.text(at, "no force", kText * scale, kInk) + kGap * scale;
    return;
  }
  at.x += canvas.text(at, "force  0", kText * scale, kInk) + 8 * scale;
  constexpr int kSteps = 60;
  const double step = 2.2 * scale;
  for (int i = 0; i < kSteps; ++i) {
    canvas.fillRectangle(at.x + i * step, at.y - 11 * scale, step + 0.5, 12 * scale, forceColor((i + 0.5) / kSteps));
  }
  at.x += kSteps * step + 8 * scale;
  const std::string words = fmt::format("{} N; {}, the longest is {} N", shortNumber(forces.most_N), arrowWords(forces),
                                        shortNumber(forces.most_N));
  at.x += canvas.text(at, words, kText * scale, kInk) + kGap * scale;
  lineItem(canvas, at, scale, kHipColor.faded(0.8), 0, "thin: depth of the press");
}

}  // namespace

void drawTitle(Canvas& canvas, const TouchRun& run, const RunFigures& figures, double width, double scale) {
  const double room = width - 32 * scale;
  std::string title = fmt::format("{}, isovalue {}", run.volume.name, shortNumber(run.volume.isovalue));
  if (figures.contact_ticks > 0) {
    title += fmt::format("; at most {} N, {} mm deep", shortNumber(figures.force_N.max),
                         shortNumber(figures.depth_m.max * kMillimetresPerMetre));
  }
  canvas.text({16 * scale, 28 * scale}, title, fittingSize(canvas, title, 20 * scale, true, room), kInk, Align::kLeft,
              true);
  const std::string sentence = verdict(run, figures);
  canvas.text({16 * scale, 50 * scale}, sentence, fittingSize(canvas, sentence, 15 * scale, false, room), kSoftInk);
}

void drawLegend(Canvas& canvas, const ForceArrows& forces, double y, double scale) {
  Pixel at{16 * scale, y + 24 * scale};
  lineItem(canvas, at, scale, kHipColor, 0, "tool (HIP)");
  lineItem(canvas, at, scale, kHipColor.faded(0.55), 5, "tool inside or behind the object");
  lineItem(canvas, at, scale, kVhipColor, 0, "its point on the surface (VHIP)");
  markItem(canvas, at, scale, kStartColor, {1, 1, 1}, "start");
  markItem(canvas, at, scale, kEndColor, {1, 1, 1}, "end");
  at = {16 * scale, y + 50 * scale};
  forceItems(canvas, at, scale, forces);
}

}  // namespace palpate
