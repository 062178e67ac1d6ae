// SPDX-License-Identifier: Apache-2.0
// Planes that are kept for 1 to 10,000 ticks, while the tool slides over a ball.
#include <cmath>

#include <fmt/format.h>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace renewal_cases {
namespace {

constexpr double kRadius_m = 20e-3, kSpeed_m_per_s = 0.05, kDepth_m = 1e-3;

// hri renews a plane early where it would be wrong; so its place stays within what the lattice and its own limits
// allow, whatever n is.
ExtremeOutcome slidesOverBall(const std::string& algorithm, int n, bool is_bounded) {
  Ground ground{.size = Vec3i::Constant(64)};
  const Vec3 centre_W(0, 0, -10e-3);
  const auto volume =
      sampledFrom(ground, 0, [=](double, const Vec3& p_W) { return (kRadius_m - (p_W - centre_W).norm()) / 1e-3; });
  RoughRun run = pressOn(volume, ground);
  run.algorithm = algorithm;
  run.parameters.plane_renewal_ticks = n;
  run.parameters.stiffness_N_per_m = 1000;
  run.seconds = 1;
  run.path_W = [=](double time_s) -> Vec3 {
    constexpr double kDown_s = 0.3;
    const double angle = kSpeed_m_per_s * std::max(0.0, time_s - kDown_s) / kRadius_m;
    const double height_m = std::max(-kDepth_m, 3e-3 - (3e-3 + kDepth_m) / kDown_s * time_s);
    return centre_W + (kRadius_m + height_m) * Vec3(std::sin(angle), 0, std::cos(angle));
  };
  Judge judge(run, play(run));
  // The sag of the lattice's cells, h^2 / (8 R) along each of three axes, the search's 0.04 voxel, and the 0.05 of the
  // depth or 0.02 voxel by which hri lets a plane be off.
  constexpr double kVoxel_m = 1e-3;
  const double bound_m = 3 * kVoxel_m * kVoxel_m / (8 * kRadius_m) + (0.04 + 0.02) * kVoxel_m + 0.05 * kDepth_m;
  double worst_m = 0;
  for (const TickRecord& record : judge.result().records) {
    if (record.time_s < 0.31) continue;
    const double exact_m = kRadius_m - (asVec3(record.hip_W) - centre_W).norm();
    const double felt_m = asVec3(record.force_W).norm() / run.parameters.stiffness_N_per_m;
    worst_m = std::max(worst_m, std::abs(felt_m - exact_m));
  }
  if (is_bounded) {
    judge.that(worst_m <= bound_m,
               fmt::format("the depth felt is off by {:g} m, and {:g} m is allowed", worst_m, bound_m));
    judge.raisesNoFadingFault();
  }
  return judge.outcome(fmt::format("depth off by {:.3g} mm at most", worst_m * 1e3));
}

}  // namespace
}  // namespace renewal_cases

void addRenewalCases(ExtremeCases& to) {
  using namespace renewal_cases;
  for (const int n : {1, 2, 100, 1000, 10000}) {
    to.push_back({"renewal", fmt::format("hri, n of {}", n), "a ball is felt within hri's own bounds",
                  [=] { return slidesOverBall("hri", n, true); }});
  }
  for (const int n : {1, 100, 10000}) {
    to.push_back({"renewal", fmt::format("hri-paper, n of {}", n),
                  "no force beyond the limits, however old the plane is",
                  [=] { return slidesOverBall("hri-paper", n, false); }});
  }
  to.push_back(
      {"renewal", "n of 0", "refused", [] { return refusedWith("0", [] { (void)slidesOverBall("hri", 0, false); }); }});
}

}  // namespace palpate
