// SPDX-License-Identifier: Apache-2.0
// What holds for every algorithm of the registry, over random scenes: a new algorithm joins on its own.
//
// A scene is a random smooth field (waves of 8 to 25 voxels) with a random smooth path through it, a random n and
// stiffness; the seeds are fixed.
#include <algorithm>
#include <map>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"
#include "servo/window/window_sampler.hpp"
#include "support/algorithm_setups.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace properties_test {

constexpr double kVoxel = 1e-3;
constexpr int kSide = 40;
constexpr int kSeeds = 12;
constexpr int kTicks = 1200;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3 direction() { return Vec3(between(-1, 1), between(-1, 1), between(0.1, 1)).normalized(); }

 private:
  std::mt19937 engine_;  // its numbers are the same everywhere, those of distributions are not
};

// A sum of waves: density in units, isovalue 0, highest density at most 3.
std::function<double(const Vec3&)> waves(Random& random) {
  struct Wave {
    Vec3 k;
    double phase;
  };
  std::vector<Wave> all;
  for (int i = 0; i < 6; ++i) {
    all.push_back({random.direction() * (6.28 / (random.between(8, 25) * kVoxel)), random.between(0, 6.28)});
  }
  return [=](const Vec3& p_W) {
    double sum = -0.5;
    for (const Wave& wave : all) sum += 0.5 * std::sin(wave.k.dot(p_W) + wave.phase);
    return sum;
  };
}

struct RandomScene {
  explicit RandomScene(unsigned seed) {
    Random random(seed);
    volume = millimetreVolume(waves(random), kSide);
    volume.hold(held, Vec3i::Zero(), Vec3i::Constant(kSide));
    parameters.plane_renewal_ticks = 1 + static_cast<int>(random.between(0, 10));
    parameters.stiffness_N_per_m = random.between(100, 2000);
    parameters.damping_Ns_per_m = random.between(0, 2);
    // Through the middle half of the volume, 0.4 m/s at most.
    Vec3 phase, pace;
    for (int a = 0; a < 3; ++a) {
      phase[a] = random.between(0, 6.28);
      pace[a] = random.between(0.004, 0.02);
    }
    for (int i = 0; i < kTicks; ++i) {
      const Vec3 turn = phase + pace * i;
      path.push_back(Vec3::Constant(0.5 * (kSide - 1) * kVoxel) + 12 * kVoxel * turn.array().sin().matrix());
    }
  }
  [[nodiscard]] Vec3 velocity(std::size_t tick) const {
    return tick == 0 ? Vec3(Vec3::Zero()) : Vec3((path[tick] - path[tick - 1]) * 1000);
  }
  [[nodiscard]] double density(const Vec3& p_W) const { return WindowSampler(held.window).at(p_W).density; }

  AnalyticVolume volume;
  HeldWindow held;
  AlgorithmParameters parameters;
  std::vector<Vec3> path;
};

constexpr double kContrast = 3;

// Each is made once.
const RandomScene& randomScene(unsigned seed) {
  static std::map<unsigned, RandomScene> scenes;
  return scenes.try_emplace(seed, seed).first->second;
}

// What each tick of `algorithm` gives over the scene's path, seen in a world that is turned and moved by X.
std::vector<TickOutput> traceOf(std::string_view name, const RandomScene& scene,
                                const Eigen::Isometry3d& X = Eigen::Isometry3d::Identity()) {
  const auto algorithm = makeFor(name, scene.parameters, scene.volume, kContrast);
  SampleWindow window = scene.held.window;
  window.lattice.R_WL = X.rotation() * window.lattice.R_WL;
  window.lattice.origin_W = X * window.lattice.origin_W;
  algorithm->reset(X * scene.path[0]);
  std::vector<TickOutput> outs(scene.path.size());
  for (std::size_t i = 0; i < outs.size(); ++i) {
    algorithm->tick({X * scene.path[i], X.rotation() * scene.velocity(i), &window}, outs[i]);
  }
  return outs;
}

class Properties : public testing::TestWithParam<std::string> {};
// What touches a mesh of the isosurface is held against that mesh, in tests/servo/objects: its triangles lie beside the
// samples' own surface, and empty space has none.
class FieldProperties : public Properties {};

// |F| <= K |VHIP - HIP| + B |v|, and not more than K over the longest way to a surface here. Haptization's is that of
// its table, 3 N and 2 N s/m (TransferFunction::standard).
TEST_P(Properties, ForcesAreFiniteAndBounded) {
  int contacts = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const RandomScene& scene = randomScene(seed);
    const auto outs = traceOf(GetParam(), scene);
    for (std::size_t i = 0; i < outs.size(); ++i) {
      const TickOutput& out = outs[i];
      ASSERT_TRUE(out.force_W.allFinite() && out.vhip_W.allFinite() && out.normal_W.allFinite()) << seed << " " << i;
      const double speed = scene.velocity(i).norm();
      const double depth_m = (out.vhip_W - scene.path[i]).norm();
      double bound_N = scene.parameters.stiffness_N_per_m * depth_m + scene.parameters.damping_Ns_per_m * speed;
      if (GetParam() == "haptization") bound_N = 3 + 2 * speed;
      ASSERT_LE(out.force_W.norm(), bound_N * (1 + 1e-12)) << seed << " " << i;
      ASSERT_LE(depth_m, 24 * kVoxel) << seed << " " << i;  // twice the path's reach
      contacts += out.in_contact ? 1 : 0;
    }
  }
  EXPECT_GT(contacts, 1000);  // the scenes are felt
}

// Without contact there is no force, no normal and no plane; the VHIP is the HIP. (Haptization is viscous without.)
TEST_P(Properties, NothingWithoutContact) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const RandomScene& scene = randomScene(seed);
    const auto outs = traceOf(GetParam(), scene);
    for (std::size_t i = 0; i < outs.size(); ++i) {
      if (outs[i].in_contact) {
        ASSERT_NEAR(outs[i].normal_W.norm(), 1, 1e-9);
        continue;
      }
      ASSERT_TRUE(GetParam() == "haptization" || outs[i].force_W.isZero(0)) << seed << " " << i;
      ASSERT_TRUE(outs[i].normal_W.isZero(0)) << seed << " " << i;
      ASSERT_EQ(outs[i].vhip_W, scene.path[i]) << seed << " " << i;
    }
  }
}

// Until the path first comes into the object there is no force and no fault.
TEST_P(FieldProperties, NothingBeforeTheFirstTouch) {
  int ticks = 0;
  for (unsigned seed = 1; seed <= 2 * kSeeds; ++seed) {
    const RandomScene& scene = randomScene(seed);
    const auto outs = traceOf(GetParam(), scene);
    for (std::size_t i = 0; i < outs.size() && scene.density(scene.path[i]) <= 0; ++i, ++ticks) {
      ASSERT_TRUE(outs[i].force_W.isZero(0)) << seed << " " << i;
      ASSERT_FALSE(outs[i].in_contact);
      ASSERT_EQ(outs[i].faults, 0u) << faultNames(outs[i].faults);
    }
  }
  EXPECT_GT(ticks, 500);
}

// Free space of every kind: flat, sloped, and around the object, for every n.
TEST_P(FieldProperties, FreeSpaceIsFreeOfForceAndFaults) {
  const Vec3 centre_W = Vec3::Constant(19.5e-3);
  for (const auto& density :
       {std::function<double(const Vec3&)>([](const Vec3&) { return -1.0; }), ball(centre_W, 8e-3)}) {
    const AnalyticVolume volume = millimetreVolume(density, kSide);
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), Vec3i::Constant(kSide));
    for (int n = 1; n <= 10; ++n) {
      AlgorithmParameters parameters;
      parameters.plane_renewal_ticks = n;
      const auto algorithm = makeFor(GetParam(), parameters, volume, 8e-3);
      const auto hip = [&](int i) {
        const double a = 0.05 * i;
        return Vec3(centre_W + Vec3(std::cos(a), std::sin(a), 0.3 * std::sin(3 * a)) * (10e-3 + 2e-3 * std::sin(a)));
      };
      algorithm->reset(hip(0));
      for (int i = 0; i < 300; ++i) {
        TickOutput out;
        algorithm->tick({hip(i), Vec3(0.5, 0, 0), &held.window}, out);
        ASSERT_TRUE(out.force_W.isZero(0)) << n << " " << i;
        ASSERT_EQ(out.faults, 0u) << n << " " << i << " " << faultNames(out.faults);
      }
    }
  }
}

// The same samples in a turned and moved lattice, under the same path turned and moved, give the same trace turned and
// moved. Places in the lattice then differ by some 1e-13 voxel, but a weight of the interpolation is a float, which may
// fall to its neighbour: 6e-8 of a lerp, so densities differ by some 1e-6 and gradients by 1e-6 of 1 per voxel. A VHIP
// is a residual over a gradient: where the steepness is 0.05 per voxel, 2e-5 voxel; a normal turns as much. What one
// tick leaves to the next shrinks in every algorithm, so it does not add up beyond a few times that.
TEST_P(FieldProperties, TurningAndMovingTheSceneTurnsAndMovesTheTrace) {
  constexpr double kPart = 1e-4;  // of a voxel, of a unit normal
  int contacts = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const RandomScene& scene = randomScene(seed);
    Random random(1000 + seed);
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.rotate(Eigen::AngleAxisd(random.between(0, 3), random.direction()));
    X.pretranslate(Vec3(random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(-0.2, 0.2)));
    const auto here = traceOf(GetParam(), scene);
    const auto there = traceOf(GetParam(), scene, X);
    for (std::size_t i = 0; i < here.size(); ++i) {
      ASSERT_EQ(there[i].in_contact, here[i].in_contact) << seed << " " << i;
      ASSERT_EQ(there[i].faults, here[i].faults) << seed << " " << i;
      ASSERT_EQ(there[i].plane_age_ticks, here[i].plane_age_ticks) << seed << " " << i;
      ASSERT_LT((there[i].vhip_W - X * here[i].vhip_W).norm(), kPart * kVoxel) << seed << " " << i;
      ASSERT_LT((there[i].normal_W - X.rotation() * here[i].normal_W).norm(), kPart) << seed << " " << i;
      const double depth_m = (here[i].vhip_W - scene.path[i]).norm();
      const double force_N = scene.parameters.stiffness_N_per_m * (kVoxel + depth_m) + here[i].force_W.norm();
      ASSERT_LT((there[i].force_W - X.rotation() * here[i].force_W).norm(), kPart * force_N) << seed << " " << i;
      contacts += here[i].in_contact ? 1 : 0;
    }
  }
  EXPECT_GT(contacts, 1000);
}

// A run that ends anywhere, in contact or not, leaves nothing to the next one.
TEST_P(FieldProperties, AResetForgetsEverything) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const RandomScene& scene = randomScene(seed);
    const auto fresh = traceOf(GetParam(), scene);
    for (const std::size_t first_run : {std::size_t{37}, scene.path.size() / 3, scene.path.size() / 2}) {
      const auto algorithm = makeFor(GetParam(), scene.parameters, scene.volume, kContrast);
      TickOutput out;
      algorithm->reset(scene.path[0]);
      for (std::size_t i = 0; i < first_run; ++i) {
        algorithm->tick({scene.path[i], scene.velocity(i), &scene.held.window}, out);
      }
      algorithm->reset(scene.path[0]);
      for (std::size_t i = 0; i < 600; ++i) {
        algorithm->tick({scene.path[i], scene.velocity(i), &scene.held.window}, out);
        ASSERT_EQ(out.force_W, fresh[i].force_W) << seed << " " << first_run << " " << i;
        ASSERT_EQ(out.faults, fresh[i].faults) << seed << " " << first_run << " " << i;
      }
    }
  }
}

// What the registry says of an algorithm is what it does: n changes its force or not, and its VHIP leaves the HIP or
// not.
TEST_P(FieldProperties, TraitsAreTrue) {
  bool differs = false, leaves = false;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    RandomScene every(seed), seldom(seed);
    every.parameters.plane_renewal_ticks = 1;
    seldom.parameters.plane_renewal_ticks = 10;
    const auto a = traceOf(GetParam(), every), b = traceOf(GetParam(), seldom);
    for (std::size_t i = 0; i < a.size(); ++i) {
      differs = differs || a[i].force_W != b[i].force_W;
      leaves = leaves || a[i].vhip_W != every.path[i];
    }
  }
  EXPECT_EQ(algorithmEntry(GetParam()).traits.renews_planes, differs);
  EXPECT_EQ(algorithmEntry(GetParam()).traits.shows_surface, leaves);
}

std::vector<std::string> names(bool with_meshes) {
  std::vector<std::string> all;
  for (const AlgorithmEntry& entry : algorithms()) {
    if (with_meshes || !entry.needs.isosurface_mesh) all.emplace_back(entry.name);
  }
  return all;
}

std::string asWord(const testing::TestParamInfo<std::string>& name) {
  std::string word = name.param;
  std::replace(word.begin(), word.end(), '-', '_');
  return word;
}

INSTANTIATE_TEST_SUITE_P(Each, Properties, testing::ValuesIn(names(true)), asWord);
INSTANTIATE_TEST_SUITE_P(Each, FieldProperties, testing::ValuesIn(names(false)), asWord);

}  // namespace properties_test
}  // namespace palpate
