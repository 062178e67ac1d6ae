// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/placed_device.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace placed_device_test {

// Says where it is, and keeps what it was told.
class Handle final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "handle"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    return {.force_limit_N = 6,
            .position_resolution_m = 1e-5,
            .slew_limit_N_per_s = 600,
            .follows_force = follows_force,
            .stiffness_limit_N_per_m = 900,
            .workspace_radius_m = 0.1,
            .motion = kHandMotion};
  }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return {HandParameters{}}; }
  [[nodiscard]] bool read(Vec3& p) noexcept override {
    if (answers) p = at_D;
    return answers;
  }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return off; }
  [[nodiscard]] bool pressed() const noexcept override { return is_pressed; }
  [[nodiscard]] bool write(const Vec3& f) noexcept override {
    force_D = f;
    return takes;
  }
  [[nodiscard]] Vec3 held(const Vec3& f) const noexcept override { return f.norm() > 6 ? Vec3(f.normalized() * 6) : f; }

  Vec3 at_D = Vec3::Zero(), force_D = Vec3::Zero();
  bool is_pressed = false, answers = true, takes = true, follows_force = true;
  ForceOff off = ForceOff::kNone;
};

struct Placed {
  explicit Placed(const Placement& placement = {}) {
    auto inner = std::make_unique<Handle>();
    handle = inner.get();
    device = std::make_unique<PlacedDevice>(std::move(inner), placement);
  }
  Vec3 at(const Vec3& p_D) {
    handle->at_D = p_D;
    Vec3 p;
    EXPECT_TRUE(device->read(p));
    return p;
  }
  Handle* handle;
  std::unique_ptr<PlacedDevice> device;
};

Placement anyPlacement(Seeded& random) {
  return {.at_W = random.inCube(0.3),
          .R_WD = random.axes(false),
          .scale = random.logBetween(0.05, 20),
          .force_scale = random.logBetween(0.1, 10)};
}

TEST(PlacedDevice, FacesThePatient) {
  const Eigen::Matrix3d axes = facingThePatient();
  EXPECT_EQ(axes * Vec3(1, 0, 0), Vec3(1, 0, 0));   // to the right: the patient's left
  EXPECT_EQ(axes * Vec3(0, 1, 0), Vec3(0, 0, 1));   // up: superior
  EXPECT_EQ(axes * Vec3(0, 0, 1), Vec3(0, -1, 0));  // towards the user: anterior
  EXPECT_EQ(axes.determinant(), 1);
}

TEST(PlacedDevice, ScalesTurnsAndMoves) {
  Placed placed({.at_W = {1, 2, 3}, .R_WD = facingThePatient(), .scale = 10, .force_scale = 0.5});
  EXPECT_NEAR((placed.at({0.01, 0.02, 0.03}) - Vec3(1.1, 1.7, 3.2)).norm(), 0, 1e-12);
  EXPECT_TRUE(placed.device->write({2, 4, 6}));
  EXPECT_NEAR((placed.handle->force_D - Vec3(1, 3, -2)).norm(), 0, 1e-12);
}

// In any placement: what the hand gives in work at the handle is what the scene takes, times scale over force_scale;
// and a wall of the device's stiffest is told as what it is in the scene.
TEST(PlacedDevice, KeepsWorkAndTellsLimitsInTheScenesMeasures) {
  Seeded random(3);
  for (int i = 0; i < 200; ++i) {
    const Placement p = anyPlacement(random);
    Placed placed(p);
    const Vec3 begin = placed.at(random.inCube(0.05)), from_D = placed.handle->at_D;
    const Vec3 end = placed.at(random.inCube(0.05));
    const Vec3 force = random.inCube(1);
    ASSERT_TRUE(placed.device->write(force));
    const double scene_J = force.dot(end - begin), device_J = placed.handle->force_D.dot(placed.handle->at_D - from_D);
    EXPECT_NEAR(device_J, scene_J * p.force_scale / p.scale, 1e-12);
    const DeviceLimits limits = placed.device->limits();
    EXPECT_DOUBLE_EQ(limits.force_limit_N * p.force_scale, 6);
    EXPECT_DOUBLE_EQ(limits.slew_limit_N_per_s * p.force_scale, 600);
    EXPECT_DOUBLE_EQ(limits.position_resolution_m, 1e-5 * p.scale);
    EXPECT_DOUBLE_EQ(limits.workspace_radius_m, 0.1 * p.scale);
    EXPECT_DOUBLE_EQ(limits.motion.speed_m_per_s, kHandMotion.speed_m_per_s * p.scale);
    EXPECT_DOUBLE_EQ(limits.motion.acceleration_m_per_s2, kHandMotion.acceleration_m_per_s2 * p.scale);
    EXPECT_NEAR(limits.stiffness_limit_N_per_m * p.scale * p.force_scale, 900, 1e-9);
    EXPECT_NEAR(placed.device->hands()[0].device_mass_kg * p.scale * p.force_scale, HandParameters{}.device_mass_kg,
                1e-15);
    const Vec3 large = 100 * force / p.force_scale;
    EXPECT_NEAR((placed.device->held(large) - large.normalized() * std::min(large.norm(), 6 / p.force_scale)).norm(), 0,
                1e-9);
  }
}

TEST(PlacedDevice, TheClutchKeepsTheToolWhereItIs) {
  Placed placed({.scale = 2});
  EXPECT_EQ(placed.at({0.01, 0, 0}), Vec3(0.02, 0, 0));
  placed.handle->is_pressed = true;
  EXPECT_EQ(placed.at({0.02, 0.01, 0}), Vec3(0.02, 0, 0));
  EXPECT_NEAR((placed.at({-0.03, 0, 0}) - Vec3(0.02, 0, 0)).norm(), 0, 1e-15);
  ASSERT_TRUE(placed.device->write({1, 1, 1}));
  EXPECT_EQ(placed.handle->force_D, Vec3(Vec3::Zero()));
  EXPECT_EQ(placed.device->held({1, 1, 1}), Vec3(Vec3::Zero()));
  placed.handle->is_pressed = false;
  EXPECT_NEAR((placed.at({-0.04, 0, 0}) - Vec3(0.02, 0, 0)).norm(), 0, 1e-15);  // the way until the release was seen
  EXPECT_NEAR((placed.at({-0.03, 0, 0}) - Vec3(0.04, 0, 0)).norm(), 0, 1e-15);
  Placed without({.clutch = false});
  without.handle->is_pressed = true;
  EXPECT_EQ(without.at({0.02, 0, 0}), Vec3(0.02, 0, 0));
}

// 5 mm beyond a radius of 100 mm: 300 N/m times that, inwards, and half its square of energy.
TEST(PlacedDevice, PushesBackAtTheEndOfItsWorkspace) {
  Placed placed({.at_W = {1, 0, 0}, .R_WD = facingThePatient(), .scale = 4, .force_scale = 0.5});
  static_cast<void>(placed.at({0, 0.099, 0}));
  EXPECT_EQ(placed.device->boundary().stored_J, 0);
  static_cast<void>(placed.at({0, 0.105, 0}));
  const DeviceBoundary edge = placed.device->boundary();
  EXPECT_NEAR((edge.force_W - Vec3(0, 0, -300 * 0.005 / 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR(edge.stored_J, 0.5 * 300 * 0.005 * 0.005 * 4 / 0.5, 1e-15);
  placed.handle->is_pressed = true;
  EXPECT_EQ(placed.device->boundary().stored_J, 0);
  Placed none({.edge_stiffness_N_per_m = 0});
  static_cast<void>(none.at({0, 0.2, 0}));
  EXPECT_EQ(none.device->boundary().force_W, Vec3(Vec3::Zero()));
}

// ---- an edge that begins where the hand is ----

double edgeForce(const Placed& placed) {
  return placed.device->boundary().force_W.norm();
}

TEST(PlacedDevice, DoesNotPushAHandThatBeginsOutside) {
  Placed placed;
  static_cast<void>(placed.at({0, 0.2, 0}));
  EXPECT_EQ(placed.device->boundary().stored_J, 0);
  static_cast<void>(placed.at({0, 0.15, 0}));  // it closes in
  EXPECT_EQ(edgeForce(placed), 0);
  static_cast<void>(placed.at({0, 0, 0.155}));
  EXPECT_NEAR(edgeForce(placed), 300 * 0.005, 1e-12);
  static_cast<void>(placed.at({0, 0, 0.145}));
  EXPECT_EQ(edgeForce(placed), 0);
  static_cast<void>(placed.at({0, 0, 0.01}));  // no farther in than the workspace
  static_cast<void>(placed.at({0.1, 0, 0}));
  EXPECT_EQ(edgeForce(placed), 0);
  static_cast<void>(placed.at({0.104, 0, 0}));
  EXPECT_NEAR(edgeForce(placed), 300 * 0.004, 1e-12);
}

// It may have gone anywhere while there was no force: uncalibrated, disconnected, clutched; or by a jump.
TEST(PlacedDevice, BeginsItsEdgeAnewWhereTheForceWasAway) {
  const std::function<void(Placed&)> causes[] = {
      [](Placed& placed) {
        placed.handle->off = ForceOff::kUncalibrated;
        static_cast<void>(placed.at({0, 0.05, 0}));
        placed.handle->off = ForceOff::kNone;  // the answer that calibrates it also says where it is
        static_cast<void>(placed.at({0, 0.18, 0}));
      },
      [](Placed& placed) {
        placed.handle->off = ForceOff::kDisconnected;
        placed.handle->answers = false;
        Vec3 unused;
        EXPECT_FALSE(placed.device->read(unused));
        placed.handle->answers = true;
        placed.handle->off = ForceOff::kNone;
        static_cast<void>(placed.at({0, 0.18, 0}));
      },
      [](Placed& placed) {
        placed.handle->is_pressed = true;
        static_cast<void>(placed.at({0, 0.15, 0}));
        placed.handle->is_pressed = false;
        static_cast<void>(placed.at({0, 0.18, 0}));
      },
      [](Placed& placed) {
        static_cast<void>(placed.at({0, 0.18, 0}));
        EXPECT_NEAR(edgeForce(placed), 300 * 0.08, 1e-9);
        placed.device->beginAnew();
      }};
  for (const auto& cause : causes) {
    Placed placed;
    static_cast<void>(placed.at({0, 0, 0}));
    cause(placed);
    EXPECT_EQ(edgeForce(placed), 0);
    static_cast<void>(placed.at({0, 0.19, 0}));
    EXPECT_NEAR(edgeForce(placed), 300 * 0.01, 1e-9);
    static_cast<void>(placed.at({0, 0.08, 0}));
    static_cast<void>(placed.at({0, 0.11, 0}));
    EXPECT_NEAR(edgeForce(placed), 300 * 0.01, 1e-9);
  }
}

// On any way of small steps: the spring is that of a radius which is the least distance so far, but never below the
// workspace's; it is continuous, and the work that it did is exactly what it lost. Over a step of s the work of the
// mean force is that of the spring, but for the turn of the force: k s^2 / 2 at most where the edge sets in, and
// k d s^2 / R where the force turns by s / R.
TEST(PlacedDevice, AnEdgeThatClosesInGivesNoEnergy) {
  constexpr double kStiffness = 300, kRadius_m = 0.1, kStep_m = 2e-5;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    Placed placed;
    Vec3 p_D = random.between(0.02, 0.25) * random.direction(), way = random.direction();
    double least_m = p_D.norm(), work_J = 0, slack_J = 0;
    static_cast<void>(placed.at(p_D));
    DeviceBoundary before = placed.device->boundary();
    ASSERT_EQ(before.stored_J, 0);
    for (int step = 0; step < 20000; ++step) {
      if (random.pick(1000) == 0) way = (random.direction() - 2 * p_D).normalized();
      const Vec3 next_D = p_D + kStep_m * way;
      static_cast<void>(placed.at(next_D));
      least_m = std::min(least_m, next_D.norm());
      const double beyond_m = std::max(0.0, next_D.norm() - std::max(kRadius_m, least_m));
      const DeviceBoundary now = placed.device->boundary();
      ASSERT_NEAR(now.stored_J, 0.5 * kStiffness * beyond_m * beyond_m, 1e-12);
      ASSERT_NEAR(now.force_W.norm(), kStiffness * beyond_m, 1e-9);
      // In device and world of the same size and force the turn alone differs, so lengths are the same.
      ASSERT_LE((now.force_W - before.force_W).norm(), 2 * kStiffness * kStep_m);
      const Vec3 way_W = next_D - p_D;
      work_J += 0.5 * (now.force_W + before.force_W).dot(way_W);
      slack_J += 0.5 * kStiffness * kStep_m * kStep_m * (1 + 2 * beyond_m / kRadius_m);
      ASSERT_NEAR(-work_J, now.stored_J, slack_J);
      before = now;
      p_D = next_D;
    }
    EXPECT_LT(slack_J, 3e-3);  // 10 mm of the spring are 15 mJ
  }
}

TEST(PlacedDevice, HandsFailuresOn) {
  Placed placed;
  placed.handle->answers = false;
  Vec3 before(1, 2, 3);
  EXPECT_FALSE(placed.device->read(before));
  EXPECT_EQ(before, Vec3(1, 2, 3));
  placed.handle->takes = false;
  EXPECT_FALSE(placed.device->write({1, 0, 0}));
}

TEST(PlacedDevice, RefusesWhatIsNoPlacement) {
  Eigen::Matrix3d mirrored = Eigen::Matrix3d::Identity();
  mirrored(0, 0) = -1;
  const double nan = std::nan("");
  for (const Placement& p :
       {Placement{.scale = 0}, Placement{.scale = -1}, Placement{.scale = INFINITY}, Placement{.force_scale = 0},
        Placement{.force_scale = nan}, Placement{.at_W = Vec3(nan, 0, 0)}, Placement{.R_WD = mirrored},
        Placement{.R_WD = 2 * Eigen::Matrix3d::Identity()}, Placement{.edge_stiffness_N_per_m = -1}})
    EXPECT_THROW(PlacedDevice(std::make_unique<Handle>(), p), Error);
}

// One that no force moves begins where it is put, wherever it was moved before; one with forces has a frame of its own.
TEST(PlacedDevice, IsPutInSeveralPlacesOneAfterAnother) {
  Seeded random(9);
  for (const bool follows : {false, true}) {
    const auto handle = std::make_shared<Handle>();
    handle->follows_force = follows;
    for (int volume = 0; volume < 100; ++volume) {
      const Placement placement = anyPlacement(random);
      PlacedDevice device(handle, placement);
      const Vec3 begins_D = random.inCube(0.1), goes_D = random.inCube(0.1);
      Vec3 at_W;
      handle->at_D = begins_D;
      ASSERT_TRUE(device.read(at_W));
      const Vec3 from_D = follows ? Vec3(Vec3::Zero()) : begins_D;
      const auto placed = [&](const Vec3& p_D) {
        return Vec3(placement.at_W + placement.scale * (placement.R_WD * (p_D - from_D)));
      };
      EXPECT_LT((at_W - placed(begins_D)).norm(), 1e-12);
      handle->at_D = begins_D + goes_D;
      ASSERT_TRUE(device.read(at_W));
      EXPECT_LT((at_W - placed(begins_D + goes_D)).norm(), 1e-12);
    }
  }
}

}  // namespace placed_device_test
}  // namespace palpate
