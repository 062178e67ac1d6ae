// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/plane_age.hpp"

#include <algorithm>
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

// How deep a place in the object is, along its outward normal [m]; at most kDeepest voxels.
double depthAt(const SurfaceField& surface, const Vec3& p_W, const Vec3& normal_W, double voxel_m) {
  constexpr int kDeepest = 64, kStepsAVoxel = 2;
  double density = 0, before = 0;
  Vec3 gradient_W = Vec3::Zero();
  for (int i = 0; i <= kDeepest * kStepsAVoxel; ++i) {
    const double out_m = i * voxel_m / kStepsAVoxel;
    before = density;
    if (!surface.sample(p_W + out_m * normal_W, density, gradient_W)) return out_m;
    if (density > surface.isovalue()) continue;
    const double back = i > 0 ? (surface.isovalue() - density) / (before - density) : 0;
    return out_m - back * voxel_m / kStepsAVoxel;
  }
  return kDeepest * voxel_m;
}

// What ages a plane at one place of the path; empty where it does not touch.
std::optional<PlaneAge> ageAt(const SurfaceField& surface, const Vec3& p_W, const Vec3& velocity_W) {
  if (!isInside(surface, p_W)) return {};
  const std::optional<Vec3> normal_W = levelNormal(surface, p_W);
  if (!normal_W) return {};
  const double voxel_m = surface.lattice().smallestSpacing();
  PlaneAge age{.depth_m = depthAt(surface, p_W, *normal_W, voxel_m), .voxel_m = voxel_m};
  const Vec3 along_W = velocity_W - normal_W->dot(velocity_W) * *normal_W;
  age.speed_m_per_s = along_W.norm();
  if (!(age.speed_m_per_s > 0)) return age;
  const Vec3 step_W = along_W / age.speed_m_per_s * voxel_m;
  const auto ahead_W = levelNormal(surface, p_W + step_W), behind_W = levelNormal(surface, p_W - step_W);
  if (!ahead_W || !behind_W) return {};
  age.curvature_per_m = (*ahead_W - *behind_W).norm() / (2 * voxel_m);
  return age;
}

// At kPlaces of the path.
std::vector<PlaneAge> agesAlong(const Path& path, const SurfaceField& surface, double rate_hz) {
  const double step_s = 1 / rate_hz;
  std::vector<PlaneAge> ages;
  for (int i = 0; i < kPlaces; ++i) {
    const double time_s = path.duration_s() * (i + 0.5) / kPlaces;
    const Vec3 velocity_W = (path.position(time_s + step_s) - path.position(time_s - step_s)) / (2 * step_s);
    if (auto age = ageAt(surface, path.position(time_s), velocity_W)) {
      age->rate_hz = rate_hz;
      ages.push_back(*age);
    }
  }
  return ages;
}

double errorOf(std::vector<PlaneAge> ages, PlaneAgeError planeAgeError, int n) {
  std::vector<double> errors_m;
  for (PlaneAge& age : ages) {
    age.n = n;
    errors_m.push_back(planeAgeError(age));
  }
  std::sort(errors_m.begin(), errors_m.end());
  return quantile(errors_m, 0.9);
}

}  // namespace

double planeAgeError(const Path& path, const SurfaceField& surface, std::string_view algorithm, int n, double rate_hz) {
  return errorOf(agesAlong(path, surface, rate_hz), algorithmEntry(algorithm).plane_age_error, n);
}

std::optional<std::string> noteOnPlaneAge(const Scene& scene, const Path& path, const SurfaceField& surface) {
  const AlgorithmEntry& algorithm = algorithmEntry(scene.algorithm);
  if (!algorithm.traits.renews_planes) return {};
  const std::vector<PlaneAge> ages = agesAlong(path, surface, scene.rate_hz);
  const int n = scene.plane_renewal_ticks;
  const auto error = [&](int ticks) { return errorOf(ages, algorithm.plane_age_error, ticks); };
  const auto isFelt = [&](int ticks) { return stiffnessOf(scene) * error(ticks) >= kFeltStep_N; };
  if (!isFelt(n)) return {};
  int allowed = 0;  // the largest n that is not felt
  for (int felt = n; felt - allowed > 1;) {
    const int middle = allowed + (felt - allowed) / 2;
    (isFelt(middle) ? felt : allowed) = middle;
  }
  const std::string remedy = allowed >= 1 ? fmt::format("--n {} keeps it below {} N", allowed, shortNumber(kFeltStep_N))
                                          : "move more slowly or raise --rate";
  return fmt::format(
      "a plane is kept for up to {} ticks, in which the surface bends by {} mm under this path, so the force is off by "
      "up to {} N; {}",
      n, shortNumber(error(n) * kMillimetresPerMetre), shortNumber(stiffnessOf(scene) * error(n)), remedy);
}

}  // namespace palpate
