// SPDX-License-Identifier: Apache-2.0
// Effects on rough surfaces: noise, masks, edits under the tool. In a tick the force changes by no more than the effect
// alone would make of it, on the exact surface, and the plane, without effect.
//
// A press and a slide of 16 mm at 0.1 m/s, 1 to 8 mm deep, on a ball of 20 mm or a plane in voxels of 1 mm that lie
// anyhow; 500 N/m. The bound is that of the promise: 1.5 times the largest change of the same effect on the exact
// surface, plus that of the plain run on the same samples.
#include <algorithm>
#include <cmath>
#include <list>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/texture.hpp"
#include "support/algorithm_driver.hpp"
#include "support/effect_kinds.hpp"
#include "support/sampled_volume.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace rough_effects_test {

constexpr double kVoxel = 1e-3;
constexpr double kRadius = 20e-3;
constexpr double kStep = 0.1e-3;  // a tick [m]
constexpr double kSlide = 16e-3;
constexpr double kContrast = 1e-3;  // of the density that a millimetre of depth makes

struct Ground {
  Ground(bool is_plane, unsigned seed) : plane(is_plane) {
    Seeded random(77 * seed);
    middle_W = random.inCube(kVoxel);
    out_W = random.direction();
    aside_W = random.across(out_W);
  }
  [[nodiscard]] Vec3 at(double way_m, double depth_m) const {
    if (plane) return middle_W + out_W * (kRadius - depth_m) + aside_W * way_m;
    const double angle = way_m / kRadius;
    return middle_W + (out_W * std::cos(angle) + aside_W * std::sin(angle)) * (kRadius - depth_m);
  }
  [[nodiscard]] Vec3 normal(const Vec3& p_W) const { return plane ? out_W : Vec3((p_W - middle_W).normalized()); }
  [[nodiscard]] AnalyticSurface surface() const {
    return plane ? planeSurface(at(0, 0), out_W) : ballSurface(middle_W, kRadius);
  }
  bool plane;
  Vec3 middle_W, out_W, aside_W;
};

constexpr double kMask = -1;  // in place of a noise

AnalyticVolume volumeOf(const Ground& ground, const AnalyticSurface& surface, double noise, unsigned seed) {
  Sampling sampling{.size = Vec3i::Constant(72), .noise_m = noise == kMask ? 0 : noise * kVoxel, .seed = seed};
  sampling.lattice = latticeAround(ground.at(8e-3, 0), sampling.size, Vec3::Constant(kVoxel));
  AnalyticVolume volume = sampledOn(sampling, surface);
  if (noise == kMask) {
    volume.density = [exact = volume.density](const Vec3& p_W) { return exact(p_W) > 0 ? 0.5e-3 : -0.5e-3; };
  }
  return volume;
}

// A brush of 5 mm that adds or takes half a millimetre ahead of the tool, every 15 ticks; none: nothing is edited.
enum class Brush { kNone, kAdds, kTakes };

struct Felt {
  double change_N = 0;  // the largest from tick to tick
  int lost = 0;         // ticks of the slide without contact
  std::vector<double> degrees, forces_N;
};

Felt feel(const Ground& ground, const AnalyticVolume& volume, int effect, double depth_m, int n,
          Brush brush = Brush::kNone, double noise = 0, unsigned seed = 0) {
  AlgorithmSetup setup;
  setup.parameters = {.stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = n};
  setup.effects = makeContactEffects(effectOf(effect, 0, kContrast), 500, 1000);
  const auto hri = makeAlgorithm("hri", std::move(setup));
  AlgorithmDriver driver(*hri, volume, ground.at(0, -3e-3));
  driver.around_vhip = true;
  Felt felt;
  Vec3 last_W = Vec3::Zero();
  const auto tick = [&](double way_m, double deep_m, bool slides) {
    const Vec3 hip_W = ground.at(way_m, deep_m);
    const TickOutput out = driver.at(hip_W);
    felt.change_N = std::max(felt.change_N, (out.force_W - last_W).norm());
    last_W = out.force_W;
    if (!slides) return;
    felt.lost += out.in_contact ? 0 : 1;
    const Vec3 n_W = ground.normal(hip_W);
    felt.degrees.push_back(std::atan2(out.force_W.cross(n_W).norm(), out.force_W.dot(n_W)) * kDegreesPerRadian);
    felt.forces_N.push_back(out.force_W.norm());
  };
  for (double deep_m = -3e-3; deep_m < depth_m; deep_m += kStep) tick(0, deep_m, false);
  std::list<AnalyticVolume> edited;
  AnalyticSurface surface = ground.surface();
  int ticks = 0;
  for (double way_m = 0; way_m < kSlide; way_m += kStep, ++ticks) {
    if (brush != Brush::kNone && ticks % 15 == 7) {
      const bool adds = brush == Brush::kAdds;
      const Vec3 centre_W = ground.at(way_m + 1e-3, adds ? 4.5e-3 : -4.5e-3);
      surface.distance_m = [before = surface.distance_m, centre_W, adds](const Vec3& p_W) {
        const double of_ball_m = (p_W - centre_W).norm() - 5e-3;
        return adds ? std::min(before(p_W), of_ball_m) : std::max(before(p_W), -of_ball_m);
      };
      edited.push_back(volumeOf(ground, surface, noise, seed));
      driver.edit(edited.back());
    }
    tick(way_m, depth_m, true);
  }
  return felt;
}

double middleOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class RoughEffects : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Each, RoughEffects, testing::Range(static_cast<int>(kShading), static_cast<int>(kEffectKinds)),
                         [](const auto& test) { return std::string(kEffectNames[test.param]); });

// Depths and n from all over; the exact surface is that of the same press. Before there was a felt surface, shading
// changed the force by up to 3.6 N a tick, the procedural texture by 6.2, stiffness by 4.5.
TEST_P(RoughEffects, TheForceChangesNoFasterThanEffectAndPlaneDo) {
  double nearest = 0;
  for (unsigned seed = 1; seed <= (isLongRun() ? 40U : 6U); ++seed) {
    Seeded random(seed);
    const Ground ground(seed % 2 == 0, seed);
    const double depth_m = random.logBetween(1e-3, 8e-3);
    const int n = static_cast<int>(std::lround(random.logBetween(1, 8)));
    const AnalyticVolume exact = stored(volumeOf(ground, ground.surface(), 0, seed));
    const double exact_N = feel(ground, exact, GetParam(), depth_m, n).change_N;
    for (const double noise : {0.04, 0.1, 0.25, kMask}) {
      const AnalyticVolume rough = stored(volumeOf(ground, ground.surface(), noise, seed));
      const Felt plain = feel(ground, rough, kNone, depth_m, n);
      const Felt felt = feel(ground, rough, GetParam(), depth_m, n);
      const double bound_N = 1.5 * exact_N + plain.change_N;
      EXPECT_LE(felt.change_N, bound_N) << "noise " << noise << ", seed " << seed << ", " << depth_m << " deep, n "
                                        << n;
      EXPECT_LE(felt.lost, plain.lost) << seed;
      nearest = std::max(nearest, felt.change_N / bound_N);
    }
  }
  RecordProperty("largest share of the bound", fmt::format("{:.2f}", nearest));
}

TEST_P(RoughEffects, NorDoesItUnderABrush) {
  for (unsigned seed = 1; seed <= (isLongRun() ? 12U : 2U); ++seed) {
    Seeded random(100 + seed);
    const Ground ground(seed % 2 == 0, seed);
    const double depth_m = random.logBetween(1e-3, 4e-3);
    const int n = static_cast<int>(std::lround(random.logBetween(1, 8)));
    for (const Brush brush : {Brush::kAdds, Brush::kTakes}) {
      const AnalyticVolume exact = volumeOf(ground, ground.surface(), 0, seed);
      const double exact_N = feel(ground, exact, GetParam(), depth_m, n, brush, 0, seed).change_N;
      for (const double noise : {0.1, 0.25, kMask}) {
        const AnalyticVolume rough = volumeOf(ground, ground.surface(), noise, seed);
        const double plain_N = feel(ground, rough, kNone, depth_m, n, brush, noise, seed).change_N;
        EXPECT_LE(feel(ground, rough, GetParam(), depth_m, n, brush, noise, seed).change_N, 1.5 * exact_N + plain_N)
            << "noise " << noise << ", seed " << seed << ", " << depth_m << " deep, n " << n << " "
            << (brush == Brush::kAdds ? "adds" : "takes");
      }
    }
  }
}

// On a rough surface the shaded force points nearer to the truth than the plane's: it is smoothed, and does not lag.
TEST(RoughShading, PointsNearerToTheTruth) {
  for (const double noise : {0.1, 0.25, kMask}) {
    std::vector<double> plain, shaded;
    for (unsigned seed = 1; seed <= 6; ++seed) {
      const Ground ground(seed % 2 == 0, seed);
      const AnalyticVolume rough = stored(volumeOf(ground, ground.surface(), noise, seed));
      for (const double depth_m : {2e-3, 7e-3}) {
        for (double degrees : feel(ground, rough, kNone, depth_m, 5).degrees) plain.push_back(degrees);
        for (double degrees : feel(ground, rough, kShading, depth_m, 5).degrees) shaded.push_back(degrees);
      }
    }
    EXPECT_LT(middleOf(shaded), (noise == kMask ? 1.1 : 1.0) * middleOf(plain)) << noise;
    RecordProperty(fmt::format("degrees at noise {}", noise),
                   fmt::format("{:.1f}, unshaded {:.1f}", middleOf(shaded), middleOf(plain)));
  }
}

// On the exact ball the texture is what its formula says at the surface point under the tool, within 5 % of D': d = D'
// (1 + h s') N less D' s times grad h, which the curvature makes R / (R - D) times as steep. The sampled surface errs
// by samplingBound() and the plane, up to n ticks old, by kMostTurned.
TEST(RoughEffectsOnTheExactBall, TheTextureIsThatOfTheFormula) {
  const double amplitude_m = 0.1e-3, wavelength_m = 1e-3;
  const ProceduralTexture texture(amplitude_m, wavelength_m);
  // texture.hpp: how the share falls beyond 2A.
  const double most_m = 3 / (amplitude_m * std::pow(2 * std::numbers::pi / wavelength_m, 2));
  const double fall_m = std::sqrt(std::pow(most_m - amplitude_m, 2) - std::pow(2 * amplitude_m, 2));
  for (const double depth_m : {1e-3, 3e-3, 6e-3}) {
    const Ground ground(false, 5);
    const AnalyticVolume exact = stored(volumeOf(ground, ground.surface(), 0, 5));
    AlgorithmSetup setup;
    setup.parameters = {.stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = 1};
    setup.effects = makeContactEffects(effectOf(kProcedural, 0, kContrast), 500, 1000);
    const auto hri = makeAlgorithm("hri", std::move(setup));
    AlgorithmDriver driver(*hri, exact, ground.at(0, -3e-3));
    driver.around_vhip = true;
    for (double deep_m = -3e-3; deep_m < depth_m; deep_m += kStep) driver.at(ground.at(0, deep_m));
    for (double way_m = 0; way_m < kSlide; way_m += kStep) {
      const Vec3 hip_W = ground.at(way_m, depth_m), n_W = ground.normal(hip_W);
      const Vec3 p_W = ground.middle_W + kRadius * n_W;
      const auto height = [&](const Vec3& at_W) { return texture.height(at_W); };
      constexpr double kQ = 0.1e-6;
      Vec3 slope_W;
      for (int axis = 0; axis < 3; ++axis)
        slope_W[axis] = (height(p_W + kQ * Vec3::Unit(axis)) - height(p_W - kQ * Vec3::Unit(axis))) / (2 * kQ);
      slope_W -= n_W * n_W.dot(slope_W);
      const double x = (depth_m - 2 * amplitude_m) / fall_m, share = std::pow(1 + x * x, -0.5);
      const double share_per_m = -x * std::pow(share, 3) / fall_m;
      const double raised_m = depth_m + share * height(p_W);
      const Vec3 wanted_W =
          raised_m * (1 + height(p_W) * share_per_m) * n_W - raised_m * share * kRadius / (kRadius - depth_m) * slope_W;
      const Vec3 d_W = driver.at(hip_W).force_W / 500;
      ASSERT_LE((d_W - wanted_W).norm(), 0.05 * raised_m) << depth_m << " " << way_m;
    }
  }
}

}  // namespace rough_effects_test
}  // namespace palpate
