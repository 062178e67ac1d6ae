// SPDX-License-Identifier: Apache-2.0
#include "apps/view/panel.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kLeastStep_px = 1.5;  // points nearer to each other are left out
constexpr double kHiddenShare = 0.55;  // how much of its colour remains to a hidden line
constexpr Color kWhite = {1, 1, 1};

Vec3 vec(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

}  // namespace

Panel::Panel(Canvas& canvas, const Camera& camera, const RenderedImage& image, double tolerance_m, double scale)
    : canvas_(canvas), camera_(camera), image_(image), tolerance_m_(tolerance_m), scale_(scale) {}

bool Panel::isVisible(const Camera::Projection& p) const {
  if (p.x < 0 || p.y < 0 || p.x >= image_.width || p.y >= image_.height)
    return true;  // beside the picture nothing hides
  const auto at =
      static_cast<std::size_t>(p.y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(p.x);
  return p.distance_m <= static_cast<double>(image_.distance_m[at]) + tolerance_m_;
}

std::vector<Panel::Place> Panel::places(const std::vector<Vec3>& points_W) const {
  std::vector<Place> out;
  for (std::size_t i = 0; i < points_W.size(); ++i) {
    const auto p = camera_.project(points_W[i]);
    if (!p) continue;
    const bool last = i + 1 == points_W.size();
    if (!last && !out.empty() && std::hypot(p->x - out.back().pixel.x, p->y - out.back().pixel.y) < kLeastStep_px)
      continue;
    out.push_back({{p->x, p->y}, isVisible(*p)});
  }
  return out;
}

// Stretches of equal visibility, each one polyline; neighbours share their border point.
void Panel::drawPlaces(const std::vector<Place>& places, const Color& color, double line) {
  for (std::size_t begin = 0; begin + 1 < places.size();) {
    std::vector<Pixel> stretch = {places[begin].pixel};
    std::size_t i = begin + 1;
    for (; i < places.size(); ++i) {
      stretch.push_back(places[i].pixel);
      if (places[i].visible != places[begin].visible) break;
    }
    const bool visible = places[begin].visible;
    if (visible) canvas_.polyline(stretch, kWhite.faded(0.7), line + 2.2 * scale_);
    canvas_.polyline(stretch, visible ? color : color.faded(kHiddenShare), visible ? line : 0.8 * line,
                     visible ? 0 : 5 * scale_);
    begin = i;
  }
}

void Panel::drawHipPath(const std::vector<TickRecord>& records) {
  std::vector<Vec3> points_W;
  for (const TickRecord& record : records) points_W.push_back(vec(record.hip_W));
  drawPlaces(places(points_W), kHipColor, 2.4 * scale_);
}

void Panel::drawVhipPath(const std::vector<TickRecord>& records) {
  std::vector<Vec3> points_W;
  for (std::size_t i = 0; i <= records.size(); ++i) {
    if (i < records.size() && records[i].in_contact) {
      points_W.push_back(vec(records[i].vhip_W));
    } else if (!points_W.empty()) {
      drawPlaces(places(points_W), kVhipColor, 2.6 * scale_);
      points_W.clear();
    }
  }
}

// Closely spaced points: what the surface hides of a line is found point by point.
void Panel::drawObjects(const std::vector<std::vector<Vec3>>& outlines_W) {
  for (const std::vector<Vec3>& line_W : outlines_W) drawPlaces(places(line_W), kObjectColor, 1.6 * scale_);
}

void Panel::drawForces(const ForceArrows& forces, double longest_m) {
  if (forces.most_N <= 0) return;
  for (const ForceArrow& arrow : forces.arrows) {
    const auto from = camera_.project(arrow.vhip_W), hip = camera_.project(arrow.hip_W);
    const auto to = camera_.project(arrow.vhip_W + longest_m / forces.most_N * arrow.force_W);
    if (!from || !hip || !to) continue;
    const Color color = forceColor(arrow.force_W.norm() / forces.most_N).faded(isVisible(*from) ? 1 : kHiddenShare);
    canvas_.polyline({{from->x, from->y}, {hip->x, hip->y}}, kHipColor.faded(0.8),
                     1.2 * scale_);  // the depth of the press
    canvas_.disc({hip->x, hip->y}, 2.2 * scale_, kHipColor, kHipColor);
    canvas_.arrow({from->x, from->y}, {to->x, to->y}, color, 2.6 * scale_);
    canvas_.disc({from->x, from->y}, 3 * scale_, isVisible(*from) ? kWhite : kWhite.faded(kHiddenShare), kVhipColor);
  }
}

bool Panel::isInside(const Vec3& p_W) const {
  const auto p = camera_.project(p_W);
  const double room = 14 * scale_;
  return p && p->x >= room && p->y >= room && p->x <= image_.width - room && p->y <= image_.height - room;
}

void Panel::drawMark(const Vec3& p_W, const Color& color, const std::string& word) {
  const auto p = camera_.project(p_W);
  if (!p) return;
  canvas_.disc({p->x, p->y}, 6 * scale_, color, kWhite);
  const bool right_half = p->x > 0.8 * image_.width;
  canvas_.text({p->x + (right_half ? -10 : 10) * scale_, p->y + 5 * scale_}, word, 14 * scale_, color,
               right_half ? Align::kRight : Align::kLeft, true, true);
}

void Panel::drawEnds(const std::vector<TickRecord>& records) {
  const auto inside = [this](const TickRecord& r) { return isInside(vec(r.hip_W)); };
  const auto first = std::find_if(records.begin(), records.end(), inside);
  if (first == records.end()) return;
  const auto last = std::find_if(records.rbegin(), records.rend(), inside);
  drawMark(vec(first->hip_W), kStartColor, first == records.begin() ? "start" : "from start");
  drawMark(vec(last->hip_W), kEndColor, last == records.rbegin() ? "end" : "to end");
}

void Panel::drawScaleBar(const Vec3& at_W) {
  const double depth_m = (at_W - camera_.position_W).dot(camera_.forward_W);
  if (!(depth_m > 0)) return;
  const double pixel_m = camera_.pixelSize(depth_m), length_m = roundDown(0.25 * image_.width * pixel_m);
  const double left = 16 * scale_, right = left + length_m / pixel_m, y = image_.height - 16 * scale_,
               tick = 5 * scale_;
  const std::vector<Pixel> bar = {{left, y - tick}, {left, y}, {right, y}, {right, y - tick}};
  canvas_.polyline(bar, kWhite.faded(0.85), 5 * scale_);
  canvas_.polyline(bar, kInk, 2 * scale_);
  canvas_.text({(left + right) / 2, y - 8 * scale_}, fmt::format("{:g} mm", length_m * kMillimetresPerMetre),
               14 * scale_, kInk, Align::kCentre, false, true);
}

void Panel::drawCaption(const std::string& words) {
  canvas_.text({16 * scale_, 26 * scale_}, words, 15 * scale_, kInk, Align::kLeft, true, true);
}

}  // namespace palpate
