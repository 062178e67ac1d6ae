// SPDX-License-Identifier: Apache-2.0
#include "apps/onlook/seen_volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace palpate {
namespace {

constexpr std::size_t kDirectionsAPoint = 4;  // many points are the outermost of several

// The first of these are as evenly over the sphere as all of them: an additive sequence in two dimensions whose steps
// are powers of the plastic number (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
Vec3 direction(std::size_t i) {
  constexpr double kPlastic = 1.32471795724474602596;
  const auto n = static_cast<double>(i);
  const double z = 2 * std::fmod(0.5 + n / kPlastic, 1) - 1;
  const double angle = 2 * std::numbers::pi * std::fmod(0.5 + n / (kPlastic * kPlastic), 1);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

SeenExtent withFewerPoints(const SeenExtent& extent, std::size_t most) {
  if (extent.points_W.size() <= most) return extent;
  std::set<std::size_t> kept;
  for (std::size_t i = 0; i < kDirectionsAPoint * most && kept.size() < most; ++i) {
    const Vec3 along = direction(i);
    const auto furthest =
        std::ranges::max_element(extent.points_W, {}, [&](const Vec3& point_W) { return point_W.dot(along); });
    kept.insert(static_cast<std::size_t>(furthest - extent.points_W.begin()));
  }
  SeenExtent fewer{.middle_W = extent.middle_W, .points_W = {}};
  for (const std::size_t i : kept) fewer.points_W.push_back(extent.points_W[i]);
  return fewer;
}

}  // namespace palpate
