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

bool overlap(const LabelBox& a, const LabelBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

}  // namespace

void LabelPlacer::avoidLine(const std::vector<Pixel>& points) {
  if (!points.empty()) points_.push_back(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Pixel &a = points[i - 1], &b = points[i];
    // What is beside the picture is in nobody's way; a long line out of it would be many points.
    const double length = std::min(std::hypot(b.x - a.x, b.y - a.y), 4 * (width_ + height_));
    const int steps = std::max(1, static_cast<int>(length / kStep_px));
    for (int n = 1; n <= steps; ++n) {
      const double t = static_cast<double>(n) / steps;
      points_.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
}

double LabelPlacer::cost(const LabelBox& box) const {
  double cost = 0;
  if (box.left < 0 || box.top < 0 || box.right > width_ || box.bottom > height_) cost += kOutside;
  for (const LabelBox& other : boxes_) cost += overlap(box, other) ? kCovered : 0;
  for (const Pixel& p : points_) {
    if (p.x > box.left && p.x < box.right && p.y > box.top && p.y < box.bottom) ++cost;
  }
  return cost;
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
      const double x = at.x + side.x * (further * gap + width / 2);
      const double y = at.y + side.y * (further * gap + height / 2);
      const LabelBox box = {x - width / 2, y - height / 2, x + width / 2, y + height / 2};
      const double its_cost = kFurther * (further - 1) + cost({box.left - kRoom_px, box.top - kRoom_px,
                                                               box.right + kRoom_px, box.bottom + kRoom_px});
      if (least >= 0 && its_cost >= least) continue;
      best = box;
      least = its_cost;
    }
  }
  avoid(best);
  return best;
}

}  // namespace palpate
