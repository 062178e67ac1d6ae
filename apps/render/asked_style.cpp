// SPDX-License-Identifier: Apache-2.0
#include "apps/render/asked_style.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/render/view_words.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kRounding = 1e-9;  // of places, as a share of the volume's extent

// A volume's box by its middle and half its sides.
struct TurnedBox {
  Vec3 middle_W;    // [m]
  Mat3 half_sides;  // columns: from the middle to three faces, in the world [m]

  // How far the box reaches from its middle along a unit direction.
  [[nodiscard]] double reach(const Vec3& direction_W) const {
    return (half_sides.transpose() * direction_W).cwiseAbs().sum();
  }
};

TurnedBox turnedBox(const Lattice& lattice, const Vec3i& size) {
  const Vec3 half_L = (size - Vec3i::Ones()).cast<double>() / 2;
  return {lattice.toWorld(half_L), lattice.R_WL * half_L.cwiseProduct(lattice.spacing_m).asDiagonal()};
}

ViewPlane placed(const AskedPlane& asked, const TurnedBox& box) {
  if (!asked.is_share) return {asked.normal_W, asked.place};
  return {asked.normal_W, asked.normal_W.dot(box.middle_W) + (2 * asked.place - 1) * box.reach(asked.normal_W)};
}

// In front of it is where normal . v is above `offset_m`, for v from the middle of the box.
struct HalfSpace {
  Vec3 normal;
  double offset_m;
  [[nodiscard]] double front(const Vec3& v) const { return normal.dot(v) - offset_m; }
};

// The six faces, seen from outside, and then the planes.
std::vector<HalfSpace> halfSpaces(const Lattice& lattice, const TurnedBox& box, std::span<const ViewPlane> clips) {
  std::vector<HalfSpace> all;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 axis_W = lattice.R_WL.col(axis);
    const double half_m = axis_W.dot(box.half_sides.col(axis));
    all.push_back({axis_W, -half_m});
    all.push_back({-axis_W, -half_m});
  }
  for (const ViewPlane& clip : clips) {
    const double length = clip.normal_W.norm();
    const Vec3 unit_W = clip.normal_W / length;
    all.push_back({unit_W, clip.offset_m / length - unit_W.dot(box.middle_W)});
  }
  return all;
}

// The points where three of the planes meet and which lie behind none: all corners of a convex body.
std::vector<Vec3> meetingPoints(std::span<const HalfSpace> all, double slack_m) {
  constexpr double kParallel = 1e-9;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const Vec3 along = all[i].normal.cross(all[j].normal);
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        const double volume = along.dot(all[k].normal);
        if (std::abs(volume) < kParallel) continue;
        const Vec3 point = (all[i].offset_m * all[j].normal.cross(all[k].normal) +
                            all[j].offset_m * all[k].normal.cross(all[i].normal) + all[k].offset_m * along) /
                           volume;
        const auto holds = [&](const HalfSpace& space) { return space.front(point) >= -slack_m; };
        if (std::all_of(all.begin(), all.end(), holds)) points.push_back(point);
      }
    }
  }
  return points;
}

void checkSlices(const RenderRequest& request, const TurnedBox& box, const WorldBox& extent) {
  for (const AskedPlane& asked : request.slices) {
    const ViewPlane plane = placed(asked, box);
    const double reach_m = box.reach(plane.normal_W);
    if (std::abs(plane.offset_m - plane.normal_W.dot(box.middle_W)) <= reach_m * (1 + kRounding)) continue;
    refuse("--slice", fmt::format("'{}' lies beside the volume, which reaches from {}", asked.text, boxWords(extent)),
           "give a place in it, or a share of it like 50%");
  }
}

}  // namespace

std::vector<Vec3> clippedCorners(const Lattice& lattice, const Vec3i& size, std::span<const ViewPlane> clips) {
  const TurnedBox box = turnedBox(lattice, size);
  const double slack_m = kRounding * box.half_sides.norm();
  const std::vector<HalfSpace> all = halfSpaces(lattice, box, clips);
  std::vector<Vec3> points = meetingPoints(all, slack_m);
  // Planes that leave nothing, or only a face, have no point that is truly in front of one of them.
  for (const HalfSpace& clip : std::span(all).subspan(6)) {
    if (std::none_of(points.begin(), points.end(), [&](const Vec3& v) { return clip.front(v) > slack_m; })) return {};
  }
  for (Vec3& point : points) point += box.middle_W;
  return points;
}

DrawStyle styleOf(const RenderRequest& request, const Lattice& lattice, const Vec3i& size) {
  const TurnedBox box = turnedBox(lattice, size);
  const WorldBox extent = worldBoxOf(lattice, size);
  checkSlices(request, box, extent);
  DrawStyle style;
  style.occlusion = request.occlusion && !request.normals;
  style.normals = request.normals;
  for (const AskedPlane& asked : request.clips) style.clips.push_back(placed(asked, box));
  for (const AskedPlane& asked : request.slices) style.slices.push_back(placed(asked, box));
  style.other_isovalue = request.second;
  style.other_opacity = request.second_opacity;
  if (request.slice_range) {
    style.slice_black = request.slice_range->black;
    style.slice_white = request.slice_range->white;
  }
  if (clippedCorners(lattice, size, style.clips).empty()) {
    refuse("--clip", fmt::format("nothing is left of the volume, which reaches from {}", boxWords(extent)),
           "move a plane, or turn it round with a minus");
  }
  return style;
}

}  // namespace palpate
