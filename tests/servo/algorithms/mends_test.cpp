// SPDX-License-Identifier: Apache-2.0
// docs/hri-mends.md: each mend of hri over hri-paper, measured on both in the same situation. Kept beside them are the
// figures of hri-paper-line, the other reading of the paper's p, so that the page can say what that reading mends
// alone.
//
// The figures of that page are this test's properties: test_servo_algorithms_mends --gtest_output=json:FILE.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/safety/faults.hpp"
#include "servo/window/window_sampler.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {
namespace mends_test {

constexpr double kVoxel = 1e-3;
constexpr int kEaseTicks = 500;  // EditEase at 1 kHz
const Vec3 kCentre = Vec3::Constant(31.3e-3);

std::unique_ptr<Algorithm> make(const char* name, int n, double damping = 0) {
  AlgorithmSetup setup;
  setup.parameters = {0, 500, damping, n};
  return makeAlgorithm(name, std::move(setup));
}

struct Pair {
  double hri = 0, paper = 0;
};

class Mend : public testing::Test {
 protected:
  // Measures on both, and keeps the figures under `what`.
  template <class Measure>
  Pair both(const std::string& what, Measure measure) {
    const Pair p{measure("hri"), measure("hri-paper")};
    RecordProperty("hri " + what, fmt::format("{:.3g}", p.hri));
    RecordProperty("hri-paper " + what, fmt::format("{:.3g}", p.paper));
    RecordProperty("hri-paper-line " + what, fmt::format("{:.3g}", measure("hri-paper-line")));
    return p;
  }
};

Vec3 onBall(double radius_m, const Vec3& out = Vec3(1, 0.3, 0.2)) {
  return kCentre + out.normalized() * radius_m;
}

// Ticks until the plane is found again, n asked for.
TEST_F(Mend, CounterRenewsEveryNTicks) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  for (int n : {1, 5}) {
    const Pair ticks = both(fmt::format("ticks a plane, n = {}", n), [&](const char* name) {
      const auto algorithm = make(name, n);
      AlgorithmDriver driver(*algorithm, volume, onBall(21e-3));
      driver.at(onBall(21e-3));
      int oldest = 0;
      for (int i = 0; i < 40; ++i) oldest = std::max(oldest, driver.at(onBall(19e-3)).plane_age_ticks);
      return oldest + 1.0;
    });
    EXPECT_EQ(ticks.hri, n);
    EXPECT_EQ(ticks.paper, n + 1);
  }
}

// Along and around a knot's tube of 4 voxels, 1 voxel deep, at `speed`: median and largest angle of the force.
struct KnotSlide {
  double median_deg = 0, largest_deg = 0;
  int forceless = 0;  // ticks inside without a force
};
KnotSlide slideOnKnot(const char* name, int n, double speed_m_per_s) {
  static const TorusKnot kKnot(kCentre, 31e-3, 4e-3);
  static const AnalyticSurface kSurface = kKnot.surface();
  static const AnalyticVolume kVolume = sampledVolume(kSurface);
  const auto algorithm = make(name, n);
  double t = 0.15;
  double turn = 0.2;
  AlgorithmDriver driver(*algorithm, kVolume, kKnot.below(t, turn, -1e-3), 64);
  driver.follow = false;
  driver.at(kKnot.below(t, turn, -1e-3));
  KnotSlide slide;
  std::vector<double> degrees;
  for (double way_m = 0; way_m < 60e-3; way_m += speed_m_per_s * 1e-3) {
    const double unit_m = (kKnot.below(t + 1e-4, turn + 4e-4, 1e-3) - kKnot.below(t, turn, 1e-3)).norm();
    t += 1e-4 * speed_m_per_s * 1e-3 / unit_m;
    turn += 4e-4 * speed_m_per_s * 1e-3 / unit_m;
    const Vec3 hip_W = kKnot.below(t, turn, 1e-3);
    const TickOutput out = driver.at(hip_W);
    if (out.force_W.isZero(0)) {
      ++slide.forceless;
      continue;
    }
    const Vec3 normal_W = kSurface.normal(hip_W);
    degrees.push_back(std::atan2(out.force_W.cross(normal_W).norm(), out.force_W.dot(normal_W)) * kDegreesPerRadian);
  }
  std::sort(degrees.begin(), degrees.end());
  slide.median_deg = degrees[degrees.size() / 2];
  slide.largest_deg = degrees.back();
  return slide;
}

TEST_F(Mend, PlaneIsAtTheNearestPointAndNotOnTheRay) {
  for (int n : {1, 5}) {
    const Pair median = both(fmt::format("median degrees at 0.1 m/s, n = {}", n),
                             [&](const char* name) { return slideOnKnot(name, n, 0.1).median_deg; });
    EXPECT_LT(median.hri, 0.6 * median.paper);
    const Pair most = both(fmt::format("largest degrees at 0.1 m/s, n = {}", n),
                           [&](const char* name) { return slideOnKnot(name, n, 0.1).largest_deg; });
    EXPECT_LT(most.hri, most.paper);
    if (n == 5) {
      EXPECT_LT(median.hri, 1.0);  // 1.19 for planes that are found for the HIP as it is
    }
  }
}

// 2 mm below a ball of 20 voxels at 1 m/s with n = 50: the largest angle of the force, and the largest force over K
// depth.
TEST_F(Mend, APlaneIsRenewedByWayToo) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  struct Worst {
    double degrees = 0, share = 0;
  };
  const auto worst = [&](const char* name) {
    const auto algorithm = make(name, 50);
    const auto hip = [](int tick) {
      const double angle = 1e-3 / 18e-3 * tick;
      return Vec3(kCentre + Vec3(std::cos(angle), std::sin(angle), 0) * 18e-3);
    };
    AlgorithmDriver driver(*algorithm, volume, hip(0) + Vec3(3e-3, 0, 0), 64);
    driver.follow = false;
    driver.stroke(hip(0), 40);
    Worst most;
    for (int i = 1; i <= 100; ++i) {
      const Vec3 force_W = driver.at(hip(i)).force_W;
      const Vec3 out_W = hip(i) - kCentre;
      most.share = std::max(most.share, force_W.norm() / (500 * 2e-3));
      if (force_W.isZero(0)) continue;
      most.degrees =
          std::max(most.degrees, std::atan2(force_W.cross(out_W).norm(), force_W.dot(out_W)) * kDegreesPerRadian);
    }
    return most;
  };
  const Pair degrees = both("largest degrees, n = 50, 1 m/s", [&](const char* name) { return worst(name).degrees; });
  const Pair share =
      both("largest force over K depth, n = 50, 1 m/s", [&](const char* name) { return worst(name).share; });
  EXPECT_LT(degrees.hri, 8);
  EXPECT_GT(degrees.paper, 30);
  EXPECT_LT(share.hri, 1.1);
  EXPECT_GT(share.paper, 3);
}

// A flat surface with noise of half a voxel in every sample, pressed 8 voxels deep and slid over by 20 mm at 0.1 m/s:
// the largest step of the force, and ticks without a force. Ten surfaces.
TEST_F(Mend, ARoughSurfaceIsFeltByTheMeanOfItsNormals) {
  struct Felt {
    double step_N = 0;
    int forceless = 0;
  };
  const auto feel = [](const char* name) {
    Felt felt;
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const AnalyticVolume volume = noisy(sampledVolume(planeSurface(kCentre, Vec3(0.2, 0.1, 1))), 0.5 * kVoxel, seed);
      const auto algorithm = make(name, 5);
      const Vec3 out_W = Vec3(0.2, 0.1, 1).normalized();
      const Vec3 aside_W = out_W.cross(Vec3(0, 1, 0)).normalized();
      const Vec3 start_W = kCentre + 3e-3 * out_W - 10e-3 * aside_W;
      AlgorithmDriver driver(*algorithm, volume, start_W);
      driver.around_vhip = true;
      driver.stroke(start_W - 11e-3 * out_W, 110);
      Vec3 last_W = driver.at(start_W - 11e-3 * out_W).force_W;
      for (const TickOutput& out : driver.stroke(start_W - 11e-3 * out_W + 20e-3 * aside_W, 200)) {
        felt.step_N = std::max(felt.step_N, (out.force_W - last_W).norm());
        felt.forceless += out.force_W.isZero(0) ? 1 : 0;
        last_W = out.force_W;
      }
    }
    return felt;
  };
  const Pair step =
      both("largest step in a deep press on noise [N]", [&](const char* name) { return feel(name).step_N; });
  const Pair forceless = both("ticks of 2000 without a force in a deep press on noise",
                              [&](const char* name) { return 1.0 * feel(name).forceless; });
  EXPECT_LT(step.hri, 0.7);  // 3.3 to 3.6 with the sampled normal of one point
  EXPECT_EQ(forceless.hri, 0);
  EXPECT_GT(forceless.paper, 0);
}

// 0.3 voxel below a surface that falls and rises by 3 voxels, at 0.3 m/s: a HIP in front of its old plane is free by
// Figure 2, VHIP = HIP, and being inside it stays so.
TEST_F(Mend, AHipThatComesOutOfItsPlaneGetsANewOneAtOnce) {
  const AnalyticVolume volume =
      millimetreVolume([](const Vec3& p_W) { return 30e-3 + 1.5e-3 * std::cos(p_W.x() * 6.283 / 20e-3) - p_W.z(); });
  const Pair forceless = both("ticks inside without a force, n = 10, 0.3 m/s", [&](const char* name) {
    const auto algorithm = make(name, 10);
    const auto hip = [](int i) {
      const double x = 5e-3 + 0.3e-3 * i;
      return Vec3(x, 30e-3, 30e-3 + 1.5e-3 * std::cos(x * 6.283 / 20e-3) - 0.3e-3);
    };
    AlgorithmDriver driver(*algorithm, volume, hip(0) + Vec3(0, 0, 1e-3), 64);
    driver.follow = false;
    driver.at(hip(0) + Vec3(0, 0, 1e-3));
    int ticks = 0;
    for (int i = 0; i < 180; ++i) ticks += driver.at(hip(i)).force_W.isZero(0) ? 1 : 0;
    return static_cast<double>(ticks);
  });
  EXPECT_EQ(forceless.hri, 0);
  EXPECT_GT(forceless.paper, 0);
}

// 24 strokes of 13 mm through a wall of 1.2 voxels, 0.1 to 16 m/s: held on the side where the tool came in?
TEST_F(Mend, ThinWallsHoldAtEverySpeed) {
  const AnalyticVolume volume = millimetreVolume(shell(kCentre, 20.3e-3, 1.2e-3));
  const Pair held = both("of 24 strokes held", [&](const char* name) {
    int count = 0;
    int direction = 0;
    for (double speed : {0.1, 0.5, 1.0, 3.0, 8.0, 16.0}) {
      for (const Vec3& out : {Vec3(1, 0, 0), Vec3(-0.3, 0.5, 0.8), Vec3(1, 1, 1), Vec3(0.2, -1, 0.1)}) {
        const auto algorithm = make(name, 5);
        const double start_m = 22e-3 + 0.37e-3 * (direction++ % 7);
        AlgorithmDriver driver(*algorithm, volume, onBall(start_m, out));
        driver.at(onBall(start_m, out));
        driver.stroke(onBall(8e-3, out), std::max(1, static_cast<int>(std::lround(16 / speed))));
        const auto rest = driver.stroke(onBall(8e-3, out), 50);
        count += std::all_of(rest.begin(), rest.end(), [&](const TickOutput& t) { return t.force_W.dot(out) > 0; });
      }
    }
    return static_cast<double>(count);
  });
  EXPECT_EQ(held.hri, 24);
  EXPECT_LT(held.paper, 24);
}

// The surface moves out over VHIP and HIP, 8 voxels, and the density around them is flat: the force when hri has taken
// the new depth in; the paper's has n + 1 ticks and many more.
TEST_F(Mend, BothInsideIsSearchedOutward) {
  const AnalyticVolume before = sampledVolume(ballSurface(kCentre, 18e-3));
  const AnalyticVolume after = sampledVolume(ballSurface(kCentre, 25e-3));
  const Pair force = both("newtons 8 mm below a surface that an edit put there", [&](const char* name) {
    const auto algorithm = make(name, 5);
    AlgorithmDriver driver(*algorithm, before, onBall(19e-3));
    driver.at(onBall(19e-3));
    driver.at(onBall(17e-3));
    driver.edit(after);
    TickOutput out;
    for (int i = 0; i < 6 + kEaseTicks; ++i) out = driver.at(onBall(17e-3));
    return out.force_W.norm();
  });
  EXPECT_NEAR(force.hri, 500 * 8e-3, 500 * 0.02 * kVoxel);
  EXPECT_EQ(force.paper, 0);
}

// Half a voxel is taken away under the tool, with n = 100: how long does the VHIP stay in the air?
TEST_F(Mend, AnEditRenewsThePlaneNow) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, 20e-3));
  const AnalyticVolume after = millimetreVolume(ball(kCentre, 19.5e-3));
  const Pair stale = both("ticks on a surface that is gone, n = 100", [&](const char* name) {
    const auto algorithm = make(name, 100);
    AlgorithmDriver driver(*algorithm, before, onBall(21e-3));
    driver.at(onBall(21e-3));
    driver.at(onBall(19e-3));
    driver.edit(after);
    int ticks = 0;
    while (ticks < 300 && (driver.at(onBall(19e-3)).vhip_W - kCentre).norm() > 19.6e-3) ++ticks;
    return static_cast<double>(ticks);
  });
  EXPECT_EQ(stale.hri, 0);
  EXPECT_GE(stale.paper, 99);
}

// Two constants with a jump of one voxel between, and no gradient anywhere: the force at 1.5 mm below the jump.
TEST_F(Mend, WithoutAGradientThePlaneFacesTheWayTheToolCame) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return p_W.z() < 30e-3 ? 1.0 : -1.0; });
  HeldWindow flat;
  volume.hold(flat, Vec3i::Constant(16), Vec3i::Constant(32), 7);
  for (Sample& s : flat.samples) s.gradient_i = s.gradient_j = s.gradient_k = 0;
  const Pair force = both("newtons without a gradient", [&](const char* name) {
    const auto algorithm = make(name, 1);
    TickOutput out;
    for (double z_mm : {31.2, 28.0, 28.0}) {
      algorithm->tick({Vec3(30e-3, 30e-3, z_mm * 1e-3), Vec3::Zero(), &flat.window}, out);
    }
    return out.force_W.z();
  });
  EXPECT_NEAR(force.hri, 500 * 1.5e-3, 500 * 0.02 * kVoxel);
  EXPECT_EQ(force.paper, 0);
}

// In contact, beyond the window for a tick, and back under a window that has caught up: the force, of 0.7 N.
TEST_F(Mend, AContactOutlivesAWindowThatIsLate) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  const Pair force = both("newtons after a late window", [&](const char* name) {
    const auto algorithm = make(name, 1);
    AlgorithmDriver driver(*algorithm, volume, Vec3(30e-3, 30e-3, 31e-3), 16);
    driver.follow = false;
    driver.at(Vec3(30e-3, 30e-3, 31e-3));
    driver.at(Vec3(30e-3, 30e-3, 29e-3));
    driver.at(Vec3(45e-3, 30e-3, 29e-3));
    driver.at(Vec3(45e-3, 30e-3, 29e-3));
    driver.publish(Vec3(45e-3, 30e-3, 29e-3));
    TickOutput out;
    for (int i = 0; i < 5; ++i) out = driver.at(Vec3(45e-3, 30e-3, 29e-3));
    return out.force_W.z();
  });
  EXPECT_NEAR(force.hri, 0.7, 1e-3);
  EXPECT_EQ(force.paper, 0);
}

// Pulled out at 1 m/s from 0.1 mm below, B = 0.5 N s/m: the most that pulls the device in.
TEST_F(Mend, TheForceNeverPulls) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  const Pair pull = both("newtons of pull", [&](const char* name) {
    const auto algorithm = make(name, 1, 0.5);
    AlgorithmDriver driver(*algorithm, volume, onBall(21e-3));
    driver.at(onBall(21e-3));
    driver.at(onBall(18.9e-3));
    return std::max(0.0, -driver.at(onBall(19.9e-3)).force_W.dot(onBall(1) - kCentre));
  });
  EXPECT_EQ(pull.hri, 0);
  EXPECT_NEAR(pull.paper, 0.5 - 0.05, 0.02);
}

// 2 mm through the face where the volume cuts an object: its depth, and the angle of the force to the face.
TEST_F(Mend, ACutFaceIsASurface) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 40e-3 - p_W.z() + 0.2 * p_W.y(); });
  const Pair force = both("newtons 2 mm behind a cut face", [&](const char* name) {
    const auto algorithm = make(name, 1);
    AlgorithmDriver driver(*algorithm, volume, Vec3(65e-3, 30e-3, 20e-3), 64);
    driver.at(Vec3(65e-3, 30e-3, 20e-3));
    TickOutput out;
    for (const TickOutput& tick : driver.stroke(Vec3(61e-3, 30e-3, 20e-3), 40)) out = tick;
    for (int i = 0; i < 3; ++i) out = driver.at(Vec3(61e-3, 30e-3, 20e-3));
    return out.force_W.x();
  });
  EXPECT_NEAR(force.hri, 1, 1e-6);
  EXPECT_LT(force.paper, 0.1);
}

// Started inside, neither pushes; hri says why.
TEST_F(Mend, InsideAtTheStartIsSaid) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  const Pair said = both("ticks of 20 that say inside-object", [&](const char* name) {
    const auto algorithm = make(name, 5);
    AlgorithmDriver driver(*algorithm, volume, onBall(15e-3));
    int ticks = 0;
    for (const TickOutput& out : driver.stroke(onBall(19e-3), 20)) {
      EXPECT_TRUE(out.force_W.isZero(0)) << name;
      ticks += has(out.faults, ServoFault::kInsideObject) ? 1 : 0;
    }
    return static_cast<double>(ticks);
  });
  EXPECT_EQ(said.hri, 20);
  EXPECT_EQ(said.paper, 0);
}

}  // namespace mends_test
}  // namespace palpate
