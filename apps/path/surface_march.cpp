// SPDX-License-Identifier: Apache-2.0
#include "apps/path/surface_march.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kStepVoxels = 0.25;
constexpr double kScan = std::numbers::pi / 16;  // angle between the directions that are tried [rad]
constexpr double kSkip =
    std::numbers::pi / 24;  // the way back lies on the surface, so the scan begins a little beside it
constexpr int kMarchBisections = 24;
constexpr double kLevelling = 0.9;  // of a heading, in each step beyond an edge
constexpr double kSteepestFall =
    -40 * std::numbers::pi / 180;  // heading below which kStraight leaves the surface [rad]

// The cutting plane: angles are measured from x, the direction of the walk, towards y, out of the object.
struct Plane {
  Vec3 x_W, y_W;
  [[nodiscard]] Vec3 at(double angle) const { return std::cos(angle) * x_W + std::sin(angle) * y_W; }
};

struct Turn {
  bool border = false;            // the circle reaches past the volume
  std::optional<double> heading;  // empty where the circle meets no object
};

// Angle at which a turn from the way back, clockwise through the outside, meets the object.
Turn nextHeading(const SurfaceField& field, const Vec3& p_W, const Plane& plane, double heading, double step_m) {
  const auto height = [&](double angle) { return heightAt(field, p_W + step_m * plane.at(angle)); };
  const double back = heading + std::numbers::pi;
  double outside = back - kSkip;
  for (double angle = outside; angle > back - 2 * std::numbers::pi + kSkip; angle -= kScan) {
    const auto now = height(angle);
    if (!now) return {true, std::nullopt};
    if (*now <= 0) {
      outside = angle;
      continue;
    }
    double inside = angle;
    for (int i = 0; i < kMarchBisections; ++i) {
      const double middle = (outside + inside) / 2;
      (height(middle).value_or(0) > 0 ? inside : outside) = middle;
    }
    return {false, outside};
  }
  return {};  // free space, or a speck smaller than a step
}

}  // namespace

SurfaceCurve marchSurface(const SurfaceField& field, const SurfaceHit& start, const Vec3& direction_W, double length_m,
                          OverEdges over_edges) {
  const Vec3 along_W = direction_W - direction_W.dot(start.normal_W) * start.normal_W;
  const Plane plane{along_W.normalized(), start.normal_W};
  const int steps = static_cast<int>(std::ceil(length_m / (kStepVoxels * field.lattice().smallestSpacing())));
  SurfaceCurve curve{{start}, steps > 0 ? length_m / steps : 0};
  double heading = 0;
  for (int i = 0; i < steps; ++i) {
    const SurfaceHit& last = curve.points.back();
    const Turn turn = nextHeading(field, last.p_W, plane, heading, curve.step_m);
    const bool on_surface = turn.heading && (over_edges == OverEdges::kFollow || *turn.heading >= kSteepestFall);
    if (turn.border || (!on_surface && over_edges == OverEdges::kFollow)) break;
    // Beyond an edge: level with the start's plane, and never upwards.
    heading = on_surface ? *turn.heading : std::min(heading, 0.0) * kLevelling;
    const Vec3 p_W = last.p_W + curve.step_m * plane.at(heading);
    if (!on_surface) curve.free_m += curve.step_m;
    curve.points.push_back({p_W, on_surface ? normalAt(field, p_W).value_or(last.normal_W) : plane.y_W});
  }
  return curve;
}

}  // namespace palpate
