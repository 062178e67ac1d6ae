// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/plane_age.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "apps/report/words.hpp"
#include "apps/touch/run_notes.hpp"
#include "base/quantile.hpp"
#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

// The outward normal at a point; empty where nothing is known or the field is flat.
std::optional<Vec3> levelNormal(const SurfaceField& surface, const Vec3& p_W) {
  double density = 0;
  Vec3 gradient_W = Vec3::Zero();
  if (!surface.sample(p_W, density, gradient_W) || !(gradient_W.norm() > 0)) return {};
  return -gradient_W.normalized();
}

bool isInside(const SurfaceField& surface, const Vec3& p_W) {
  double density = 0;
  Vec3 gradient_W = Vec3::Zero();
  return surface.sample(p_W, density, gradient_W) && density > surface.isovalue();
}

// The depth error at one place of the path; empty where it does not touch or move along the surface.
std::optional<double> errorAt(const SurfaceField& surface, const Vec3& p_W, const Vec3& velocity_W, double age_s) {
  if (!isInside(surface, p_W)) return {};
  const std::optional<Vec3> normal_W = levelNormal(surface, p_W);
  if (!normal_W) return {};
  const Vec3 along_W = velocity_W - normal_W->dot(velocity_W) * *normal_W;
  const double speed_m_per_s = along_W.norm();
  if (!(speed_m_per_s > 0)) return 0.0;
  const double voxel_m = surface.lattice().smallestSpacing();
  const Vec3 step_W = along_W / speed_m_per_s * voxel_m;
  const auto ahead_W = levelNormal(surface, p_W + step_W), behind_W = levelNormal(surface, p_W - step_W);
  if (!ahead_W || !behind_W) return {};
  const double curvature_per_m = (*ahead_W - *behind_W).norm() / (2 * voxel_m);
  const double way_m = speed_m_per_s * age_s;
  return way_m * way_m * curvature_per_m / 2;
}

}  // namespace

double planeAgeError(const Path& path, const SurfaceField& surface, int n, double rate_hz) {
  const double step_s = 1 / rate_hz;
  std::vector<double> errors_m;
  for (int i = 0; i < kPlaces; ++i) {
    const double time_s = path.duration_s() * (i + 0.5) / kPlaces;
    const Vec3 p_W = path.position(time_s);
    const Vec3 velocity_W = (path.position(time_s + step_s) - path.position(time_s - step_s)) / (2 * step_s);
    if (const auto error_m = errorAt(surface, p_W, velocity_W, n * step_s)) errors_m.push_back(*error_m);
  }
  std::sort(errors_m.begin(), errors_m.end());
  return quantile(errors_m, 0.9);
}

std::optional<std::string> noteOnPlaneAge(const Scene& scene, const Path& path, const SurfaceField& surface) {
  if (!algorithmEntry(scene.algorithm).traits.renews_planes) return {};
  const int n = scene.plane_renewal_ticks;
  const double error_m = planeAgeError(path, surface, n, scene.rate_hz);
  const double error_N = stiffnessOf(scene) * error_m;
  if (error_N < kFeltStep_N) return {};
  const int allowed = static_cast<int>(n * std::sqrt(kFeltStep_N / error_N));
  const std::string remedy = allowed >= 1 ? fmt::format("--n {} keeps it below {} N", allowed, shortNumber(kFeltStep_N))
                                          : "move more slowly or raise --rate";
  return fmt::format(
      "a plane is kept for {} ticks, in which the surface bends by {} mm under this path, so the force is off by up to "
      "{} N; {}",
      n, shortNumber(error_m * kMillimetresPerMetre), shortNumber(error_N), remedy);
}

}  // namespace palpate
