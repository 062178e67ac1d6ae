// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/depth_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace palpate {
namespace {

struct Ray {
  Vec3 from_W, direction_W;
  [[nodiscard]] Vec3 at(double t_m) const { return from_W + t_m * direction_W; }
};

// Where the ray is in the volume, which ends at its outermost voxels.
std::optional<std::pair<double, double>> spanIn(const Phantom& phantom, const Ray& ray) {
  const Lattice& lattice = phantom.lattice();
  const Vec3 eye = lattice.toIndex(ray.from_W), step = lattice.toIndex(ray.at(1)) - eye;
  double begin = 0, end = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = -eye[axis] / step[axis], b = (phantom.size()[axis] - 1 - eye[axis]) / step[axis];
    if (std::isnan(a) || std::isnan(b)) return std::nullopt;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (begin >= end) return std::nullopt;
  return std::pair(begin, end);
}

struct Exact {
  std::optional<double> t_m;  // where the ray enters the object
  double deepest_m = 0;       // least signed distance along the ray before that, and up to a few voxels after it
};

Exact follow(const Phantom& phantom, const Ray& ray, double voxel_m) {
  Exact exact{std::nullopt, std::numeric_limits<double>::infinity()};
  const auto span = spanIn(phantom, ray);
  if (!span) return exact;
  double t = span->first;
  while (t <= span->second) {
    const double distance = phantom.signedDistance_m(ray.at(t));
    exact.deepest_m = std::min(exact.deepest_m, distance);
    if (distance <= 1e-4 * voxel_m) {
      if (!exact.t_m) exact.t_m = t;
      if (t > *exact.t_m + 4 * voxel_m) break;
      t += 0.1 * voxel_m;
      continue;
    }
    t += exact.t_m ? 0.1 * voxel_m : distance;
    if (exact.t_m && t > *exact.t_m + 4 * voxel_m) break;
  }
  return exact;
}

}  // namespace

DepthErrors depthErrors(const RenderedImage& image, const Camera& camera, const Phantom& phantom, int stride) {
  DepthErrors errors;
  std::vector<double> voxel;
  const double voxel_m = phantom.lattice().smallestSpacing();
  for (int y = 0; y < image.height; y += stride) {
    for (int x = 0; x < image.width; x += stride) {
      const Exact exact = follow(phantom, {camera.position_W, camera.rayThrough(x + 0.5, y + 0.5)}, voxel_m);
      const double drawn = image.distance_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                            static_cast<std::size_t>(x)];
      if (exact.t_m && std::isfinite(drawn)) {
        voxel.push_back(std::abs(drawn - *exact.t_m) / voxel_m);
      } else if (exact.t_m && exact.deepest_m < -0.5 * voxel_m) {
        ++errors.holes;
      } else if (std::isfinite(drawn) && !exact.t_m && exact.deepest_m > 0.5 * voxel_m) {
        ++errors.false_hits;
      }
    }
  }
  errors.voxel = percentiles(std::move(voxel));
  return errors;
}

}  // namespace palpate
