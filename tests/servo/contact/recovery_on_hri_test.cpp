// SPDX-License-Identifier: Apache-2.0
// Recovery time with the algorithm, where it is for: a slide through a valley whose normal turns at once.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "servo/algorithms/hri.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/contact/energy_account.hpp"
#include "support/algorithm_driver.hpp"

namespace palpate {
namespace recovery_on_hri_test {

constexpr double kRadius = 20e-3;
constexpr double kDepth = 3e-3;
constexpr double kTorusDepth = 1e-3;
constexpr double kSpeed = 0.02;  // [m/s]
constexpr double kStiffness = 500;
const Vec3 kMiddle(32e-3, 31.7e-3, 20.4e-3);

struct Slide {
  double largest_step_N = 0;  // of the force from one tick to the next
  double mean_N = 0;          // of its magnitude
  int lost = 0;               // ticks without contact
  int ticks = 0;
};

// Two balls half way into each other: between them a valley in which the normal turns by 2 asin(12 / 20) = 74 degrees.
AnalyticVolume valley() {
  const auto left = ball(kMiddle - Vec3(12e-3, 0, 0), kRadius);
  const auto right = ball(kMiddle + Vec3(12e-3, 0, 0), kRadius);
  return millimetreVolume([=](const Vec3& p) { return std::max(left(p), right(p)); });
}
// Way of a tool kDepth under it, from the height of one ball to that of the other: an arc down and an arc up.
Vec3 inValley(double way_m) {
  const double r = kRadius - kDepth;
  const double to_bottom = std::acos(12e-3 / r);  // angle at which the arcs meet, from the line of centres
  const double half_m = r * (std::numbers::pi / 2 - to_bottom);
  const double side = way_m < half_m ? -1 : 1;
  const double angle = std::numbers::pi / 2 - std::min(way_m, 2 * half_m - way_m) / r;
  return kMiddle + Vec3(side * (12e-3 - r * std::cos(angle)), 0, r * std::sin(angle));
}
constexpr double kValleyWay_m = 26e-3;

// A torus lying in the plane z = 0 of kMiddle; the tool goes round its inner side, the concave one.
AnalyticVolume torus() {
  return millimetreVolume([](const Vec3& p) {
    const Vec3 q = p - kMiddle - Vec3(0, 0, 11.6e-3);
    return 7e-3 - std::hypot(std::hypot(q.x(), q.y()) - 18e-3, q.z());
  });
}
Vec3 insideTorus(double way_m) {
  const double r = 18e-3 - 7e-3 + kTorusDepth;
  return kMiddle + Vec3(r * std::cos(way_m / r), r * std::sin(way_m / r), 11.6e-3);
}

Slide slide(const AnalyticVolume& volume, Vec3 (*at)(double way_m), const Vec3& approach_W, double way_m, int n,
            double recovery_s, double speed_m_per_s = kSpeed) {
  EffectParameters effects;
  effects.recovery_s = recovery_s;
  AlgorithmSetup setup;
  setup.parameters.plane_renewal_ticks = n;
  setup.parameters.damping_Ns_per_m = 0;
  setup.effects = makeContactEffects(effects, kStiffness, 1000);
  const auto algorithm = makeAlgorithm("hri", std::move(setup));
  AlgorithmDriver driver(*algorithm, volume, at(0) + approach_W, 24);
  driver.stroke(at(0), 100);
  Slide result;
  Vec3 last = driver.at(at(0)).force_W;
  const double step_m = speed_m_per_s / 1000;
  for (; result.ticks * step_m < way_m; ++result.ticks) {
    const TickOutput out = driver.at(at((result.ticks + 1) * step_m));
    result.lost += out.in_contact ? 0 : 1;
    result.largest_step_N = std::max(result.largest_step_N, (out.force_W - last).norm());
    result.mean_N += out.force_W.norm();
    last = out.force_W;
  }
  result.mean_N /= result.ticks;
  return result;
}

Slide slideThroughValley(int n, double recovery_s) {
  return slide(valley(), inValley, Vec3(0, 0, 5e-3), kValleyWay_m, n, recovery_s);
}

// The tool is deeper (3 voxels) than the samples round the valley's bottom (some 1.5), so the surface point has to go
// from one side to the other. It slides there by HriSurface::kSlide and kSlideByWay times the tool's way in a tick at
// most, so the force turns by up to (0.1 + 4 * 0.02 n) / 3 of itself at a switch: 0.1 N at n = 1, 0.3 N at n = 5.
// Recovery over N = 20 ticks takes a 20th of a switch in a tick; up to two others may decay meanwhile, and the tool's
// own motion adds K v T = 0.01 N. The mean: over 40 of 1300 ticks d is between two that are 74 degrees apart, up to 20
// % shorter: 0.6 % at most.
TEST(RecoveryOnHri, ForceStepsInAValleyAreATenthOrLess) {
  for (const int n : {1, 5, 10}) {
    const Slide off = slideThroughValley(n, 0);
    const Slide on = slideThroughValley(n, 0.02);
    EXPECT_EQ(off.lost, 0);
    EXPECT_EQ(on.lost, 0);
    EXPECT_GT(off.largest_step_N, 5 * kStiffness * kSpeed / 1000) << n;  // there is something to smooth
    EXPECT_LE(on.largest_step_N, 0.1 * off.largest_step_N + kStiffness * kSpeed / 1000) << n;
    EXPECT_NEAR(on.mean_N / off.mean_N, 1, 0.01) << n;
    RecordProperty("valley_n" + std::to_string(n),
                   fmt::format("off {:.4f} N, on {:.4f} N, mean {:.5f}", off.largest_step_N, on.largest_step_N,
                               on.mean_N / off.mean_N));
  }
}

// Smooth and concave, the HIP on a circle of radius r = R + D: a plane a ticks of way aside is too shallow by
// (a v T)^2 / (2 r). At a switch, n ticks after the last, the new one is f = kAim (n - 1) ticks ahead and the old one
// n - f behind, so the old one is shallower by j = n (n - 2 f) (v T)^2 / (2 r). Recovery keeps each j for (N + 1) / 2
// ticks in the mean, so the depth is too small by j (N + 1) / (2 n) in the mean. The directions of the last N ticks are
// averaged too, which takes (N v T / r)^2 / 24 of the length; as much and a tenth of the first is allowed for what else
// is of second order. And a plane is found kAimTolerance beside the place that was aimed at: f may be off by so many
// ticks of way. With planes so regular the steps cannot become smaller than j / n: what is taken up every n ticks
// has to come back. The force lags by l = (N + 1) / 2 ticks of way, so a part l / r of it drives the tool on, and
// there is no friction that pays for that: the drive is cancelled by a drag (energy_account.hpp), which takes
// (l / r)^2 / 2 of the length, and what is owed weakens the contact: of a debt q a way of D pays kRepayments q, the
// drive gives D^2 l / r over it, so q is 2 l / (r kRepayments) of the energy D^2 / 2, less what is free. A fifth of
// both is allowed for what they differ by. A plane's jumps of 0.02 voxel are passed on to drag and strength by kShare.
TEST(RecoveryOnHri, CostsTheDepthThatItsLagSays) {
  struct Case {
    int n;
    double recovery_s, speed_m_per_s;
  };
  const double r = 18e-3 - 7e-3 + kTorusDepth;
  for (const Case& c : {Case{5, 0.01, 0.05}, Case{5, 0.03, 0.1}, Case{10, 0.03, 0.1}}) {
    const Slide off = slide(torus(), insideTorus, Vec3(-2e-3, 0, 0), 60e-3, c.n, 0, c.speed_m_per_s);
    const Slide on = slide(torus(), insideTorus, Vec3(-2e-3, 0, 0), 60e-3, c.n, c.recovery_s, c.speed_m_per_s);
    EXPECT_EQ(off.lost + on.lost, 0);
    const double N = c.recovery_s * 1000, tick_m = c.speed_m_per_s / 1000;
    const double ahead = HriSurface::kAim * (c.n - 1);
    const double shallower = (c.n - 2 * ahead) * tick_m * tick_m / (2 * r) * (N + 1) / 2 / kTorusDepth;
    const double shorter = std::pow(N * tick_m / r, 2) / 24;
    const double beside = 2 * HriSurface::kAimTolerance * 1e-3 * tick_m / (2 * r) * (N + 1) / 2 / kTorusDepth;
    const double lag = (N + 1) / 2 * tick_m / r;
    const double paid = lag * lag / 2 + std::max(0.0, 2 * lag / EnergyAccount::kRepayments - EnergyAccount::kFree);
    const double less = shallower + shorter + paid;
    EXPECT_NEAR(on.mean_N / off.mean_N, 1 - less, shorter + 0.1 * shallower + beside + 0.2 * paid);
    const double passed_on_N = kStiffness * (EnergyAccount::kRepayments + 2) * EnergyAccount::kShare * 0.02e-3;
    EXPECT_LT(on.largest_step_N, 1.25 / c.n * off.largest_step_N + passed_on_N);
    RecordProperty(fmt::format("torus_n{}_{:g}ms_{:g}m_per_s", c.n, N, c.speed_m_per_s),
                   fmt::format("off {:.4f} N, on {:.4f} N, mean {:.5f}, predicted {:.5f}", off.largest_step_N,
                               on.largest_step_N, on.mean_N / off.mean_N, 1 - less));
  }
}

}  // namespace recovery_on_hri_test
}  // namespace palpate
