// SPDX-License-Identifier: Apache-2.0
// Effects on real scans, with and without edits under the tool: the promise is that on noise and masks
// (tests/servo/contact/rough_effects_test.cpp). While a contact lasts, the force changes in a tick by no more than 1.5
// times what the effect makes of the exact surface, plus what the plain run makes of the same samples.
//
// At random places of each scan's isosurface a press of 1 to 5 mm and a slide of 12 mm at 0.1 m/s; 500 N/m. Scans are
// scaled so that their smallest voxel side is 1 mm. The exact surface is a ball of 20 mm that is as steep as the scan
// is there, pressed as deep as the tool gets in the scan.
//
// Of 2,520 such runs 36 break it, by at most 1.53 times. None does so on heads and brains. They are at edges as sharp
// as a voxel, in two chests and in carbon fibres: where the plane turns by more than 30 degrees in a tick, the felt
// surface lies between two sheets.
#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "servo/algorithms/registry.hpp"
#include "support/algorithm_driver.hpp"
#include "support/effect_kinds.hpp"
#include "support/sampled_volume.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace rough_scans_test {

constexpr double kStep = 0.1e-3;  // a tick [m]
constexpr double kSlide = 12e-3;
constexpr double kRadius = 20e-3;

// At most 88 voxels along each axis, around one of the scan.
AnalyticVolume scaled(const Volume& scan, const Vec3i& middle) {
  const Vec3i first = (middle - Vec3i::Constant(44)).cwiseMax(Vec3i::Zero());
  AnalyticVolume volume;
  volume.size = (first + Vec3i::Constant(88)).cwiseMin(scan.size()) - first;
  const Vec3 spacing_m = scan.lattice().spacing_m * (1e-3 / scan.lattice().spacing_m.minCoeff());
  volume.lattice = {Vec3::Zero(), Mat3::Identity(), spacing_m};
  auto samples = std::make_shared<std::vector<double>>();
  for (int k = 0; k < volume.size.z(); ++k) {
    for (int j = 0; j < volume.size.y(); ++j) {
      for (int i = 0; i < volume.size.x(); ++i) samples->push_back(scan.value(first + Vec3i(i, j, k)));
    }
  }
  volume.samples = samples;
  return volume;
}

struct Place {
  Vec3 p_W, out_W, aside_W;
  double contrast_per_mm;
};

// The mean density of 27 voxels.
double meanAround(const Volume& scan, const Vec3i& at) {
  double sum = 0;
  for (int n = 0; n < 27; ++n) sum += scan.value(at + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
  return sum / 27;
}

// A voxel where the mean density falls through the isovalue over five voxels: not a speck of noise. The normal is that
// of the means. Empty: none was found among as many voxels as a scan of 200^3 has, tried at random.
std::optional<Vec3i> voxelOnSurface(const Volume& scan, double isovalue, Seeded& random, Vec3& out_W) {
  constexpr int kTries = 8'000'000;
  const Vec3 spacing_m = scan.lattice().spacing_m;
  for (int tried = 0; tried < kTries; ++tried) {
    const Vec3 share = random.inCube(0.4) + Vec3::Constant(0.5);
    const Vec3i at = share.cwiseProduct(scan.size().cast<double>()).array().floor().cast<int>();
    Vec3 rise;
    for (int axis = 0; axis < 3; ++axis)
      rise[axis] =
          (meanAround(scan, at + Vec3i::Unit(axis)) - meanAround(scan, at - Vec3i::Unit(axis))) / spacing_m[axis];
    if (!(rise.norm() > 0)) continue;
    out_W = -rise.normalized();
    const auto meanAt = [&](double voxels) {
      const Vec3 way = (out_W * spacing_m.minCoeff() * voxels).cwiseQuotient(spacing_m);
      return meanAround(scan, at + Vec3i(way.array().round().cast<int>()));
    };
    if (meanAt(-2.5) > isovalue && meanAt(0) > isovalue && meanAt(2.5) < isovalue) return at;
  }
  return {};
}

enum class Brush { kNone, kAdds, kTakes };

struct Press {
  double depth_m;
  int n;
  Brush brush;
};

struct Felt {
  double change_N = 0;   // the largest from tick to tick, while the contact lasts
  double deepest_m = 0;  // below the plane
};

// `bow_m`: a slide over a ball of this radius; infinite: straight on.
Felt feel(const AnalyticVolume& volume, double isovalue, const Place& place, const Press& press, int kind,
          double bow_m) {
  AlgorithmSetup setup;
  setup.parameters = {
      .isovalue = isovalue, .stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = press.n};
  setup.effects = makeContactEffects(effectOf(kind, isovalue, place.contrast_per_mm), 500, 1000);
  const auto hri = makeAlgorithm("hri", std::move(setup));
  const auto at = [&](double way_m, double depth_m) {
    if (std::isinf(bow_m)) return Vec3(place.p_W + place.aside_W * way_m - place.out_W * depth_m);
    const Vec3 out_W = place.out_W * std::cos(way_m / bow_m) + place.aside_W * std::sin(way_m / bow_m);
    return Vec3(place.p_W - place.out_W * bow_m + out_W * (bow_m - depth_m));
  };
  AlgorithmDriver driver(*hri, volume, at(0, -3e-3));
  driver.around_vhip = true;
  Felt felt;
  Vec3 last_W = Vec3::Zero();
  bool was_in_contact = false;
  const auto tick = [&](const Vec3& hip_W) {
    const TickOutput out = driver.at(hip_W);
    if (out.in_contact == was_in_contact) felt.change_N = std::max(felt.change_N, (out.force_W - last_W).norm());
    felt.deepest_m = std::max(felt.deepest_m, out.depth_m);
    was_in_contact = out.in_contact;
    last_W = out.force_W;
  };
  for (double deep_m = -3e-3; deep_m < press.depth_m; deep_m += kStep) tick(at(0, deep_m));
  AnalyticVolume edited = volume;
  std::list<AnalyticVolume> edits;
  int ticks = 0;
  for (double way_m = 0; way_m < kSlide; way_m += kStep, ++ticks) {
    if (press.brush != Brush::kNone && ticks % 15 == 7) {
      const bool adds = press.brush == Brush::kAdds;
      const Vec3 centre_W = at(way_m + 1e-3, adds ? 4.5e-3 : -4.5e-3);
      const double contrast_per_mm = place.contrast_per_mm;
      auto values = std::make_shared<std::vector<double>>(*edited.samples);
      const Vec3i first = edited.firstAround(centre_W, Vec3i::Constant(20).cwiseMin(volume.size));
      for (int m = 0; m < 8000; ++m) {
        const Vec3i v = first + Vec3i(m % 20, m / 20 % 20, m / 400);
        const double depth_mm = 5 - (volume.lattice.toWorld(v.cast<double>()) - centre_W).norm() * 1e3;
        const double brushed = isovalue + (adds ? 1 : -1) * contrast_per_mm * std::clamp(depth_mm, -4.0, 4.0);
        double& value =
            (*values)[v.x() + volume.size.x() * (v.y() + volume.size.y() * static_cast<std::size_t>(v.z()))];
        value = adds ? std::max(value, brushed) : std::min(value, brushed);
      }
      edited.samples = values;
      edits.push_back(edited);
      driver.edit(edits.back());
    }
    tick(at(way_m, press.depth_m));
  }
  return felt;
}

class RoughScans : public testing::Test {
 protected:
  // Adds the share of the bound of each effect, at one random place of a scan, and counts the runs. One that never
  // touches has no share.
  void addShares(const Volume& scan, double isovalue, unsigned seed) {
    Seeded random(seed);
    Place place;
    const std::optional<Vec3i> found = voxelOnSurface(scan, isovalue, random, place.out_W);
    ASSERT_TRUE(found) << "the scan shows no surface at its isovalue " << isovalue;
    const Vec3i voxel = *found;
    const AnalyticVolume rough = scaled(scan, voxel);
    place.aside_W = random.across(place.out_W);
    place.p_W = rough.lattice.toWorld((voxel - (voxel - Vec3i::Constant(44)).cwiseMax(Vec3i::Zero())).cast<double>());
    double rise = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3i one = Vec3i::Unit(axis);
      rise += std::pow(
          (meanAround(scan, voxel + one) - meanAround(scan, voxel - one)) / 2 / rough.lattice.spacing_m[axis], 2);
    }
    place.contrast_per_mm = std::sqrt(rise) * 1e-3;
    const Press press{random.logBetween(1e-3, 5e-3), static_cast<int>(std::lround(random.logBetween(1, 8))),
                      static_cast<Brush>(seed % 3)};
    const AnalyticVolume exact = exactBall(place, isovalue);
    constexpr double kStraight = std::numeric_limits<double>::infinity();
    const Felt plain = feel(rough, isovalue, place, press, kNone, kStraight);
    Press deepest = press;
    deepest.depth_m = plain.deepest_m;
    for (int kind = kShading; kind < kEffectKinds; ++kind) {
      const double exact_N = feel(exact, isovalue, place, deepest, kind, kRadius).change_N;
      const double felt_N = feel(rough, isovalue, place, press, kind, kStraight).change_N;
      ++runs;
      if (felt_N == 0) continue;
      const double share = felt_N / (1.5 * exact_N + plain.change_N);
      shares.push_back(share);
      EXPECT_LE(share, 1.6) << "seed " << seed << ", " << kEffectNames[kind] << ": " << felt_N << " N, exact "
                            << exact_N << ", plain " << plain.change_N << ", " << press.depth_m << " deep, n "
                            << press.n << ", brush " << static_cast<int>(press.brush);
    }
  }

  std::vector<double> shares;
  std::size_t runs = 0;

 private:
  static AnalyticVolume exactBall(const Place& place, double isovalue) {
    Sampling sampling{.size = Vec3i::Constant(72)};
    sampling.lattice = latticeAround(place.p_W, sampling.size, Vec3::Constant(1e-3));
    AnalyticVolume ball = sampledOn(sampling, ballSurface(place.p_W - place.out_W * kRadius, kRadius));
    ball.density = [isovalue, per_m = place.contrast_per_mm * 1e3, metres = ball.density](const Vec3& p_W) {
      return isovalue + per_m * metres(p_W);
    };
    return stored(ball);
  }
};

TEST_F(RoughScans, ChangeTheForceNoFasterThanEffectAndPlaneDo) {
  const auto scans = realScans();
  if (scans.empty()) GTEST_SKIP() << kNoScans;
  for (const auto& file : scans) {
    SCOPED_TRACE(file.filename().string());
    const Volume scan = loadVolume(file.string());
    const double isovalue = defaultIsovalue(scan);
    for (unsigned seed = 1; seed <= (isLongRun() ? 60U : 3U); ++seed)
      ASSERT_NO_FATAL_FAILURE(addShares(scan, isovalue, seed));
  }
  // All touch, in the seven scans of the figures above. Runs that do not touch show nothing.
  ASSERT_GT(shares.size(), runs / 2);
  const auto beyond = std::ranges::count_if(shares, [](double share) { return share > 1; });
  EXPECT_LE(beyond, 0.03 * static_cast<double>(shares.size()));
  RecordProperty("runs", fmt::format("{}", shares.size()));
  RecordProperty("of them beyond the bound", fmt::format("{}", beyond));
  RecordProperty("largest share of the bound", fmt::format("{:.2f}", *std::ranges::max_element(shares)));
}

}  // namespace rough_scans_test
}  // namespace palpate
