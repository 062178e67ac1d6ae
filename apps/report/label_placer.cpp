// SPDX-License-Identifier: Apache-2.0
#include "apps/report/label_placer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

constexpr double kStep_px = 4;  // between the points of a line
constexpr double kRoom_px = 2;  // around a label
// How bad it is beside words over one point of a line: to be further away by a gap, since words near to another thing
// are taken for its own; words over words; words that are cut off.
constexpr double kFurther = 5, kCovered = 1e4, kOutside = 1e6;
// A label at another's mark is wrong, which is worse than all of these.
constexpr double kWrongMark = 1e8, kDoubtful = 1e5, kSameMark_px = 0.5, kClearlyFarther = 1.3;
constexpr double kLeastGap = 0.9;  // of the gap that is asked for

double distance(const LabelBox& box, const Pixel& p) {
  return std::hypot(std::max({box.left - p.x, 0.0, p.x - box.right}), std::max({box.top - p.y, 0.0, p.y - box.bottom}));
}

bool overlap(const LabelBox& a, const LabelBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

}  // namespace

double numberWidth(std::string_view number, double size) noexcept {
  constexpr double kDigit = 0.64, kPlus = 0.84;  // a plus is the widest sign of a number; times the font's size
  double width = 0;
  for (const char letter : number) width += letter == '+' ? kPlus : kDigit;
  return size * width;
}

void LabelPlacer::avoidLine(const std::vector<Pixel>& points) {
  if (!points.empty()) points_.push_back(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Pixel &a = points[i - 1], &b = points[i];
    // Points outside the picture are left out; a line far out of it would have very many.
    const double length = std::min(std::hypot(b.x - a.x, b.y - a.y), 4 * (width_ + height_));
    const int steps = std::max(1, static_cast<int>(length / kStep_px));
    for (int n = 1; n <= steps; ++n) {
      const double t = static_cast<double>(n) / steps;
      points_.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
}

double LabelPlacer::cost(const LabelBox& words, const Pixel& own) const {
  double cost = 0;
  for (const Pixel& mark : marks_) {
    const bool is_own = std::hypot(mark.x - own.x, mark.y - own.y) < kSameMark_px;
    if (is_own) continue;
    const double farther = distance(words, mark) / std::max(distance(words, own), 1e-9);
    cost += farther <= 1 ? kWrongMark : farther < kClearlyFarther ? kDoubtful : 0;
  }
  const LabelBox box = {words.left - kRoom_px, words.top - kRoom_px, words.right + kRoom_px, words.bottom + kRoom_px};
  if (box.left < 0 || box.top < 0 || box.right > width_ || box.bottom > height_) cost += kOutside;
  for (const LabelBox& other : boxes_) cost += overlap(box, other) ? kCovered : 0;
  for (const Pixel& p : points_) {
    if (p.x > box.left && p.x < box.right && p.y > box.top && p.y < box.bottom) ++cost;
  }
  return cost;
}

// A box around a place, moved into the picture if it fits.
LabelBox LabelPlacer::moved(double x, double y, double width, double height) const {
  const auto within = [](double v, double half, double end) {
    return 2 * (half + kRoom_px) > end ? v : std::clamp(v, half + kRoom_px, end - half - kRoom_px);
  };
  x = within(x, width / 2, width_);
  y = within(y, height / 2, height_);
  return {x - width / 2, y - height / 2, x + width / 2, y + height / 2};
}

bool LabelPlacer::isAtAnother(const LabelBox& words, const Pixel& own) const {
  return std::any_of(marks_.begin(), marks_.end(), [&](const Pixel& mark) {
    return std::hypot(mark.x - own.x, mark.y - own.y) >= kSameMark_px && distance(words, mark) <= distance(words, own);
  });
}

LabelBox LabelPlacer::place(const Pixel& at, double gap, double width, double height) {
  struct Side {
    double x, y;  // -1, 0 or 1
  };
  constexpr std::array<Side, 8> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}}};
  LabelBox best;
  double least = -1;
  for (const double further : {1.0, 2.5, 4.0}) {
    if (least >= 0 && least <= kFurther * (further - 1)) break;  // no need to go further away
    for (const Side& side : kSides) {
      const LabelBox box = moved(at.x + side.x * (further * gap + width / 2),
                                 at.y + side.y * (further * gap + height / 2), width, height);
      const double covers_own = distance(box, at) < kLeastGap * gap ? kWrongMark : 0;
      const double its_cost = kFurther * (further - 1) + covers_own + cost(box, at);
      if (least >= 0 && its_cost >= least) continue;
      best = box;
      least = its_cost;
    }
  }
  avoid(best);
  return best;
}

}  // namespace palpate
