// SPDX-License-Identifier: Apache-2.0
#include "apps/view/panel.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kOnePlace_px = 20;    // start and end nearer to each other have one label
constexpr double kLeastStep_px = 1.5;  // points nearer to each other are left out
constexpr double kHiddenShare = 0.55;  // of a line's colour that remains where the line is hidden
constexpr Color kWhite = {1, 1, 1};
constexpr Color kBoxColor = {0.85, 0.35, 0.05};

}  // namespace

Panel::Panel(Canvas& canvas, const Camera& camera, const RenderedImage& image, double tolerance_m, double scale)
    : canvas_(canvas),
      camera_(camera),
      image_(image),
      tolerance_m_(tolerance_m),
      scale_(scale),
      labels_(image.width, image.height) {}

bool Panel::isVisible(const Camera::Projection& p) const {
  if (p.x < 0 || p.y < 0 || p.x >= image_.width || p.y >= image_.height)
    return true;  // nothing hides a point outside the picture
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

// Draws each stretch of equal visibility as one polyline; neighbours share an end point.
void Panel::drawPlaces(const std::vector<Place>& places, const Color& color, double line) {
  std::vector<Pixel> whole;
  for (const Place& place : places) whole.push_back(place.pixel);
  labels_.avoidLine(whole);
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
  for (const TickRecord& record : records) points_W.push_back(asVec3(record.hip_W));
  drawPlaces(places(points_W), kHipColor, 2.4 * scale_);
}

void Panel::drawVhipPath(const std::vector<TickRecord>& records) {
  std::vector<Vec3> points_W;
  for (std::size_t i = 0; i <= records.size(); ++i) {
    if (i < records.size() && records[i].in_contact) {
      points_W.push_back(asVec3(records[i].vhip_W));
    } else if (!points_W.empty()) {
      drawPlaces(places(points_W), kVhipColor, 2.6 * scale_);
      points_W.clear();
    }
  }
}

// Points close together, since visibility is found point by point.
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
    labels_.avoidLine({{hip->x, hip->y}, {from->x, from->y}, {to->x, to->y}});
    canvas_.disc({from->x, from->y}, 3 * scale_, isVisible(*from) ? kWhite : kWhite.faded(kHiddenShare), kVhipColor);
  }
}

bool Panel::isInside(const Vec3& p_W) const {
  const auto p = camera_.project(p_W);
  const double room = 14 * scale_;
  return p && p->x >= room && p->y >= room && p->x <= image_.width - room && p->y <= image_.height - room;
}

// Ascenders and descenders of DejaVu Sans take 0.76 and 0.24 of its size.
void Panel::writeInto(const LabelBox& box, const std::string& words, double size, const Color& color) {
  canvas_.text({box.left, box.bottom - 0.24 * size}, words, size, color, Align::kLeft, true, true);
}

void Panel::drawWords(const Pixel& at, double gap, const std::string& words, double size, const Color& color) {
  writeInto(labels_.place(at, gap, canvas_.textWidth(words, size, true), size), words, size, color);
}

void Panel::drawBox(const ContactRegion& region, const std::string& words) {
  const auto centre = camera_.project(region.centre_W);
  if (!centre) return;
  const double depth_m = (region.centre_W - camera_.position_W).dot(camera_.forward_W);
  const double half = std::max(region.radius_m / camera_.pixelSize(depth_m), 8 * scale_);
  const double left = centre->x - half, right = centre->x + half, top = centre->y - half, bottom = centre->y + half;
  canvas_.strokeRectangle(left, top, 2 * half, 2 * half, {1, 1, 1, 0.8}, 4 * scale_);
  canvas_.strokeRectangle(left, top, 2 * half, 2 * half, kBoxColor, 2 * scale_);
  labels_.avoidLine({{left, top}, {right, top}, {right, bottom}, {left, bottom}, {left, top}});
  // Its label is below or above it, whatever else is there.
  const double size = 13 * scale_;
  const double width = canvas_.textWidth(words, size, true);
  const double y = bottom + 1.5 * size < image_.height ? bottom + 1.3 * size : top - 0.5 * size;
  const double x = std::clamp(centre->x, width / 2 + 4 * scale_,
                              std::max(image_.width - width / 2 - 4 * scale_, width / 2 + 4 * scale_));
  canvas_.text({x, y}, words, size, kBoxColor, Align::kCentre, true, true);
  labels_.avoid({x - width / 2, y - 0.76 * size, x + width / 2, y + 0.24 * size});
}

void Panel::drawEnds(const std::vector<TickRecord>& records) {
  const auto inside = [this](const TickRecord& r) { return isInside(asVec3(r.hip_W)); };
  const auto first = std::find_if(records.begin(), records.end(), inside);
  if (first == records.end()) return;
  const auto last = std::find_if(records.rbegin(), records.rend(), inside);
  struct Mark {
    Pixel at;
    Color color;
    const char* word;
  };
  std::vector<Mark> marks;
  const auto mark = [&](const TickRecord& r, const Color& color, const char* word) {
    if (const auto p = camera_.project(asVec3(r.hip_W))) marks.push_back({{p->x, p->y}, color, word});
  };
  mark(*first, kStartColor, first == records.begin() ? "start" : "from start");
  mark(*last, kEndColor, last == records.rbegin() ? "end" : "to end");
  const double radius = 6 * scale_;
  for (const Mark& m : marks) {
    canvas_.disc(m.at, radius, m.color, kWhite);
    labels_.addMark(m.at);
    labels_.avoid({m.at.x - radius, m.at.y - radius, m.at.x + radius, m.at.y + radius});
  }
  constexpr double kSize = 14, kGap = 10;
  std::vector<LabelBox> boxes;
  for (const Mark& m : marks) {
    boxes.push_back(
        labels_.place(m.at, kGap * scale_, canvas_.textWidth(m.word, kSize * scale_, true), kSize * scale_));
  }
  const bool is_one_place =
      marks.size() == 2 &&
      (std::hypot(marks[0].at.x - marks[1].at.x, marks[0].at.y - marks[1].at.y) < kOnePlace_px * scale_ ||
       labels_.isAtAnother(boxes[0], marks[0].at) || labels_.isAtAnother(boxes[1], marks[1].at));
  if (is_one_place) {  // the label of one dot would be at the other too
    drawWords(marks[1].at, kGap * scale_, fmt::format("{} and {}", marks[0].word, marks[1].word), kSize * scale_, kInk);
    return;
  }
  for (std::size_t i = 0; i < marks.size(); ++i) writeInto(boxes[i], marks[i].word, kSize * scale_, marks[i].color);
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
  const std::string words = fmt::format("{:g} mm", length_m * kMillimetresPerMetre);
  canvas_.text({(left + right) / 2, y - 8 * scale_}, words, 14 * scale_, kInk, Align::kCentre, false, true);
  const double half = std::max(right - left, canvas_.textWidth(words, 14 * scale_)) / 2;
  labels_.avoid({(left + right) / 2 - half, y - 22 * scale_, (left + right) / 2 + half, y});
}

void Panel::drawCaption(const std::string& words) {
  const double width = canvas_.text({16 * scale_, 26 * scale_}, words, 15 * scale_, kInk, Align::kLeft, true, true);
  labels_.avoid({16 * scale_, 12 * scale_, 16 * scale_ + width, 30 * scale_});
}

}  // namespace palpate
