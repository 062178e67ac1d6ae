// SPDX-License-Identifier: Apache-2.0
// The two readings of the paper's p (hri_paper.hpp): from the densities at both ends of the line, and where the density
// is the isovalue on it. docs/hri-mends.md has these figures: test_servo_algorithms_paper_point
// --gtest_output=json:FILE.
//
// In all of them the density is a ramp of half-width w around the surface and flat beyond, as in a scan.
#include <algorithm>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {
namespace paper_point_test {

constexpr double kVoxel = 1e-3;      // [m]
constexpr double kHalfWidth = 3e-3;  // w: that of the phantoms [m]

std::unique_ptr<Algorithm> make(std::string_view name, int n) {
  AlgorithmSetup setup;
  setup.parameters = {0, 500, 0, n};
  return makeAlgorithm(name, std::move(setup));
}

// ---- a HIP that rests below a plane: the error of one renewal from that of the last ----

constexpr double kTop = 40e-3;

AnalyticVolume rampBelow(double half_width_m) {
  return millimetreVolume([=](const Vec3& p_W) { return std::clamp(kTop - p_W.z(), -half_width_m, half_width_m); });
}

Vec3 below(double depth_m) {
  return {31.3e-3, 30.6e-3, kTop - depth_m};
}

// How much too deep the VHIP is after each renewal; infinity when the contact is gone.
std::vector<double> errorsOf(std::string_view name, double half_width_m, double from_m, double depth_m, int renewals) {
  const AnalyticVolume volume = rampBelow(half_width_m);
  const auto algorithm = make(name, 1);
  AlgorithmDriver driver(*algorithm, volume, below(from_m), 64);
  driver.follow = false;
  driver.at(below(from_m));
  std::vector<double> errors_m;
  for (int i = 0; i < renewals; ++i) {
    TickOutput out = driver.at(below(depth_m));
    errors_m.push_back(out.in_contact ? kTop - out.vhip_W.z() : std::numeric_limits<double>::infinity());
    driver.at(below(depth_m));  // n = 1: every second tick
  }
  return errors_m;
}

// p on the way from e to D by the densities e and w at the ends: e' = e + (D - e) (0 - e) / (w - e). The ramp is linear
// and lies along the lattice, so trilinear interpolation is exact between samples, and floats of 3e-3 m leave 1e-9 m,
// which an unstable iteration multiplies; so each step is held against the formula on the error before it. Where it
// puts p beyond the ramp there is no gradient, and the contact is gone.
TEST(PaperPoint, FromTheEndsErrsByTheFormulaFromRenewalToRenewal) {
  std::mt19937 engine(1);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0);
  };
  int steps = 0, gone = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double w_m = between(1.2, 6) * kVoxel;
    const double depth_m = w_m * between(1.05, 2.5);
    const std::vector<double> errors_m = errorsOf("hri-paper", w_m, -between(0.1, 0.9) * w_m, depth_m, 12);
    for (std::size_t i = 1; i < errors_m.size(); ++i) {
      const double e = errors_m[i - 1];
      // Within a voxel of the ramp's ends the samples round its corners, within two the gradients.
      if (!(std::abs(e) < w_m - kVoxel) || depth_m < w_m + kVoxel) break;
      const double by_formula_m = e * (1 - (depth_m - e) / (w_m - e));
      if (std::abs(by_formula_m) < w_m + kVoxel) {
        EXPECT_NEAR(errors_m[i], by_formula_m, 1e-8) << depth_m / w_m << " " << i;
        ++steps;
      } else if (std::abs(by_formula_m) > w_m + 2 * kVoxel) {
        EXPECT_TRUE(std::isinf(errors_m[i])) << depth_m / w_m << " " << i;
        ++gone;
      }
    }
  }
  EXPECT_GT(steps, 300);
  EXPECT_GT(gone, 3);
}

// |1 - D / w| < 1 below D = 2 w. The first p is off by where the tool was in its last free tick.
TEST(PaperPoint, FromTheEndsIsSteadyUpToTwiceTheHalfWidthAndNotBeyond) {
  for (const double ratio : {1.4, 1.6, 1.8, 1.9}) {
    EXPECT_LT(std::abs(errorsOf("hri-paper", kHalfWidth, -0.5e-3, ratio * kHalfWidth, 80).back()), 1e-6) << ratio;
  }
  for (const double ratio : {2.1, 2.2, 2.5, 3.0, 4.0}) {
    const auto errors_m = errorsOf("hri-paper", kHalfWidth, -0.5e-3, ratio * kHalfWidth, 80);
    const auto off = [](double e) { return std::abs(e) > 0.2e-3; };
    EXPECT_TRUE(std::any_of(errors_m.end() - 20, errors_m.end(), off)) << ratio;
  }
}

// Regula falsi ends within 1e-4 of the densities at the ends of its way, so of w.
TEST(PaperPoint, OnTheLineIsSteadyAtEveryDepth) {
  std::mt19937 engine(2);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0);
  };
  for (int trial = 0; trial < 100; ++trial) {
    const double w_m = between(1.2, 6) * kVoxel;
    const double depth_m = std::min(w_m * between(0.1, 8), 30e-3);
    for (const double e : errorsOf("hri-paper-line", w_m, -between(0.1, 2) * kVoxel, depth_m, 20)) {
      ASSERT_LT(std::abs(e), 2e-4 * w_m) << depth_m / w_m;
    }
  }
}

// Deeper than the window reaches: the line needs no density at the HIP. (From the ends there is nothing to go by.)
TEST(PaperPoint, OnTheLineAPressMayBeDeeperThanTheWindow) {
  const AnalyticVolume volume = rampBelow(kHalfWidth);
  for (const double depth_m : {2e-3, 9e-3, 15e-3, 17e-3, 24e-3, 38e-3}) {
    for (const char* name : {"hri-paper-line", "hri-paper"}) {
      const auto algorithm = make(name, 3);
      AlgorithmDriver driver(*algorithm, volume, below(-1e-3), 32);
      driver.around_vhip = true;
      driver.at(below(-1e-3));
      driver.stroke(below(depth_m), static_cast<int>(depth_m / 0.1e-3));
      const TickOutput out = driver.stroke(below(depth_m) + Vec3(5e-3, 0, 0), 50).back();
      if (std::string_view(name) == "hri-paper-line") {
        EXPECT_NEAR(out.force_W.z(), 500 * depth_m, 500 * 2e-4 * kHalfWidth) << depth_m;
        EXPECT_EQ(out.faults, 0U) << depth_m;
      } else if (depth_m > 17e-3) {
        EXPECT_TRUE(out.force_W.isZero(0)) << depth_m;
      }
    }
  }
}

// ---- a slide over a ball: what the hand feels ----

struct Slide {
  double largest_deg = 0;
  double lost = 0;  // share of the ticks without a force
};

// n = 5, 0.1 m/s, on a ball of 20 voxels around samples, 100 mm; the first 50 ticks are left out. The whole volume is
// the window, so that it is the reading that loses a contact.
Slide slide(const AnalyticVolume& volume, std::string_view name, double depth_m) {
  constexpr double kRadius = 20e-3;
  const Vec3 centre_W = Vec3::Constant(31.3e-3);
  const Vec3 u = Vec3(1, 0.3, 0.2).normalized();
  const Vec3 v = u.cross(Vec3(0.1, -0.4, 1)).normalized();
  const auto at = [&](double angle, double below_m) {
    return Vec3(centre_W + (u * std::cos(angle) + v * std::sin(angle)) * (kRadius - below_m));
  };
  const auto algorithm = make(name, 5);
  AlgorithmDriver driver(*algorithm, volume, at(0, -1e-3), 64);
  driver.follow = false;
  for (double below_m = -1e-3; below_m < depth_m; below_m += 0.1e-3) driver.at(at(0, below_m));
  Slide result;
  constexpr int kTicks = 1000;
  for (int i = 0; i < kTicks; ++i) {
    const double angle = 0.1e-3 / (kRadius - depth_m) * i;
    const TickOutput out = driver.at(at(angle, depth_m));
    if (i < 50) continue;
    if (out.force_W.isZero(0)) {
      result.lost += 1.0 / (kTicks - 50);
      continue;
    }
    const Vec3 normal_W = (at(angle, 0) - centre_W).normalized();
    const double off = std::atan2(out.force_W.cross(normal_W).norm(), out.force_W.dot(normal_W)) * kDegreesPerRadian;
    result.largest_deg = std::max(result.largest_deg, off);
  }
  return result;
}

TEST(PaperPoint, InASlideTheEndsFailBeyondTwiceTheHalfWidthAndTheLineDoesNot) {
  const AnalyticSurface ball = ballSurface(Vec3::Constant(31.3e-3), 20e-3);
  AnalyticVolume volume = sampledVolume(ball);
  const auto wide = volume.density;
  volume.samples = nullptr;
  volume.density = [wide](const Vec3& p_W) { return std::clamp(wide(p_W), -kHalfWidth, kHalfWidth); };
  for (const double ratio : {0.25, 0.5, 1.0, 1.5, 1.75, 1.9, 2.0, 2.1, 2.2, 2.35, 2.5, 3.0, 3.5, 4.0}) {
    const Slide ends = slide(volume, "hri-paper", ratio * kHalfWidth);
    const Slide line = slide(volume, "hri-paper-line", ratio * kHalfWidth);
    const Slide hri = slide(volume, "hri", ratio * kHalfWidth);
    for (const auto& [name, s] : {std::pair{"hri-paper", ends}, {"hri-paper-line", line}, {"hri", hri}}) {
      RecordProperty(fmt::format("{} at {:g} w", name, ratio), fmt::format("{:.3g} {:.3g}", s.largest_deg, s.lost));
    }
    // A line from a VHIP that is 1 to 6 ticks behind leaves the HIP's normal by the way, up to 0.6 mm, over the radius
    // at which the HIP goes around; an error in the VHIP leaves the next one depth / radius of itself behind.
    const double around_m = 20e-3 - ratio * kHalfWidth;
    const double behind_deg = 0.6e-3 / around_m / (1 - ratio * kHalfWidth / 20e-3) * kDegreesPerRadian;
    EXPECT_EQ(line.lost, 0) << ratio;
    EXPECT_LE(line.largest_deg, behind_deg + 0.2) << ratio;
    EXPECT_EQ(hri.lost, 0) << ratio;
    EXPECT_LT(hri.largest_deg, line.largest_deg) << ratio;
    if (ratio <= 1.9) {
      EXPECT_EQ(ends.lost, 0) << ratio;
      EXPECT_LE(ends.largest_deg, 1.02 * line.largest_deg) << ratio;
    }
    if (ratio >= 2.1) {
      EXPECT_TRUE(ends.largest_deg > 3 * line.largest_deg || ends.lost > 0.5) << ratio;
    }
  }
}

}  // namespace paper_point_test
}  // namespace palpate
