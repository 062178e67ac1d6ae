// SPDX-License-Identifier: Apache-2.0
// Changes of the running servo: the contact goes on, the force goes over.
#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "changing_press.hpp"
#include "servo/safety/faults.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace changes_felt_test {

// K goes from 500 to 1500 N/m on a line over kGrows ticks, and back over kFalls: the contact does not notice, and no
// tick sees more than its part of the change.
TEST(ServoLoopChanges, ANewStiffnessComesOverTime) {
  const double depth_m = 1e-3;
  Press press("hri", stiff(500), pressAndHold(depth_m));
  const auto records = press.run([&](std::int64_t tick) {
    if (tick == 400) press.changes.give({.algorithm = press.make("hri", stiff(1500))});
    if (tick == 920) press.changes.give({.algorithm = press.make("hri", stiff(500))});
  });
  for (std::size_t i = 150; i < records.size(); ++i) {
    ASSERT_TRUE(records[i].in_contact) << i;
    ASSERT_EQ(records[i].faults, 0U) << i;
  }
  const double before_N = force(records[399]).norm(), after_N = force(records[910]).norm();
  EXPECT_NEAR(before_N, 0.5, 0.01);
  EXPECT_NEAR(after_N, 1.5, 0.03);
  const auto expectLine = [&](std::size_t from, std::int64_t ticks, double begin_N, double end_N) {
    for (std::int64_t t = 0; t <= ticks; ++t) {
      const double share = static_cast<double>(t) / static_cast<double>(ticks);
      EXPECT_NEAR(force(records[from + static_cast<std::size_t>(t)]).norm(), begin_N + share * (end_N - begin_N), 0.02)
          << from << "+" << t;
    }
  };
  expectLine(399, kGrows, before_N, after_N);
  expectLine(919, kFalls, after_N, before_N);
}

TEST(ServoLoopChanges, NeverAChangeIsARunWithoutThem) {
  const auto run = [](bool connected) {
    Press press("hri", stiff(500), pressAndHold(1e-3));
    SimulatedDevice device(press.device_parameters, press.path, 1000);
    ServoLoop loop(press.parameters, *press.algorithm, device, press.scene.windows, press.scene.tool);
    if (connected) loop.takeChangesFrom(press.changes);
    return loop
        .runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
          if (tick % 16 == 0) press.scene.publish(kCentre, now_ns);
          press.scene.windows.confirm(now_ns);
        })
        .records;
  };
  const auto with = run(true), without = run(false);
  ASSERT_EQ(with.size(), without.size());
  EXPECT_EQ(std::memcmp(with.data(), without.data(), with.size() * sizeof(TickRecord)), 0);
}

// From any algorithm with a surface to any other, pressed from half a voxel to 18 voxels deep, in the middle of a
// slide: the contact goes on, and the force ends as that of the new one. hri-paper keeps no contact deeper than twice
// the ramp's half-width (docs/hri-mends.md), and this field is a ramp all through.
TEST(ServoLoopChanges, EveryAlgorithmTakesOverFromEveryOther) {
  Seeded random(7);
  for (const AlgorithmEntry& from : algorithms()) {
    for (const AlgorithmEntry& to : algorithms()) {
      if (!from.traits.shows_surface || !to.traits.shows_surface || to.name == "avila" || from.name == "avila")
        continue;
      SCOPED_TRACE(fmt::format("{} to {}", from.name, to.name));
      const double depth_m = random.logBetween(0.5e-3, 6e-3);
      const double sweep = random.between(0, 0.3);
      SampledPath path({0, 0.2, 1.0}, {onBall(0, -1e-3), onBall(0, depth_m), onBall(sweep, depth_m)},
                       SampledPath::Interpolation::kLinear);
      Press press(from.name, stiff(400), std::move(path));
      const auto records = press.run([&](std::int64_t tick) {
        if (tick == 500) press.changes.give({.algorithm = press.make(to.name, stiff(400))});
      });
      double step_N = 0;
      for (std::size_t i = 300; i < records.size(); ++i) {
        ASSERT_TRUE(records[i].in_contact) << i;
        ASSERT_EQ(records[i].faults & kFadingFaults, 0U) << i;
        step_N = std::max(step_N, (force(records[i]) - force(records[i - 1])).norm());
      }
      // A chord's sagitta aside, depth stays; each algorithm finds it within 5 % and 8 degrees, and a change of plane
      // within n ticks is of that order too.
      const double depth_end_m = kRadius_m - (asVec3(records.back().hip_W) - kCentre).norm();
      EXPECT_NEAR(force(records.back()).norm(), 400 * depth_end_m, 0.05 * 400 * depth_end_m);
      EXPECT_LT(step_N, 0.15 * 400 * depth_m);
    }
  }
}

// With the tool outside a change is nothing that can be felt.
TEST(ServoLoopChanges, InFreeSpaceNothingIsFelt) {
  SampledPath away({0, 1}, {onBall(0, -2e-3), onBall(0.1, -3e-3)}, SampledPath::Interpolation::kLinear);
  Press press("hri", stiff(500), std::move(away));
  const auto records = press.run([&](std::int64_t tick) {
    if (tick % 50 == 0) press.changes.give({.algorithm = press.make(tick % 100 == 0 ? "blezek" : "hri", stiff(2000))});
  });
  for (const TickRecord& r : records) ASSERT_EQ(force(r).norm(), 0);
}

// The contact point is out of the window for a while. A change that comes meanwhile waits: the algorithm that remembers
// the contact is not thrown away.
TEST(ServoLoopChanges, WaitWhileAContactIsOnlyRemembered) {
  Press press("hri", stiff(500), pressAndHold(1e-3));
  SimulatedDevice device(press.device_parameters, press.path, 1000);
  ServoLoop loop(press.parameters, *press.algorithm, device, press.scene.windows, press.scene.tool);
  loop.takeChangesFrom(press.changes);
  const auto records = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
                             const bool away = tick >= 300 && tick < 500;
                             press.scene.publish(away ? kCentre - Vec3(0, 0, 15e-3) : onBall(0, 0), now_ns);
                             if (tick == 400) press.changes.give({.algorithm = press.make("hri", stiff(1000))});
                           })
                           .records;
  EXPECT_FALSE(records[450].in_contact);
  EXPECT_EQ(force(records[499]).norm(), 0);
  for (std::size_t i = 501; i < records.size(); ++i) ASSERT_TRUE(records[i].in_contact) << i;
  EXPECT_NEAR(force(records.back()).norm(), 1.0, 0.02);
}

// A lower limit is reached on a line, a higher one too, and none exceeds the device's.
TEST(ServoLoopChanges, AnotherForceLimitComesOverTime) {
  Press press("hri", stiff(2000), pressAndHold(2e-3));
  press.device_parameters.force_limit_N = 6;
  press.parameters.safety.force_limit_N = 3;
  const auto records = press.run([&](std::int64_t tick) {
    if (tick == 300) press.changes.give({.force_limit_N = 1.0});
    if (tick == 600) press.changes.give({.force_limit_N = 100.0});
  });
  EXPECT_NEAR(force(records[299]).norm(), 3, 1e-9);
  EXPECT_NEAR(force(records[450]).norm(), 1, 1e-9);
  EXPECT_NEAR(force(records.back()).norm(), 4, 0.05);  // K depth
  // From 3 to 1 N in kFalls ticks, from 1 N to the device's 6 N in kGrows.
  for (std::size_t i = 150; i < records.size(); ++i) {
    const double grown_N = force(records[i]).norm() - force(records[i - 1]).norm();
    ASSERT_LE(grown_N, 5.0 / kGrows + 1e-9) << i;
    ASSERT_GE(grown_N, -2.0 / kFalls - 1e-9) << i;
  }
}

TEST(ServoLoopChanges, NoForceLimitExceedsTheDevices) {
  Press press("hri", stiff(5000), pressAndHold(3e-3));
  press.device_parameters.force_limit_N = 6;
  press.parameters.safety.force_limit_N = 2;
  const auto records = press.run([&](std::int64_t tick) {
    if (tick == 300) press.changes.give({.force_limit_N = 100.0});
  });
  EXPECT_NEAR(force(records.back()).norm(), 6, 1e-9);
}

// Changes at random, as sliders and buttons give them, faster than they can be taken: K, n, algorithm, force limit. The
// contact never ends and no fault takes the force; no tick changes it by more than what the largest change gives in a
// tick and the slide itself.
TEST(ServoLoopChanges, AtRandomNeverLoseAContact) {
  constexpr const char* kNames[] = {"hri", "blezek", "implicit"};
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    const double depth_m = random.logBetween(0.3e-3, 8e-3);
    SampledPath path({0, 0.2, 3.0}, {onBall(0, -1e-3), onBall(0, depth_m), onBall(0.25, depth_m)},
                     SampledPath::Interpolation::kLinear);
    Press press(kNames[random.pick(3)], stiff(random.between(100, 1000)), std::move(path));
    const auto records = press.run([&](std::int64_t tick) {
      if (tick < 250 || random.pick(20) != 0) return;
      ServoChange change;
      if (random.pick(3) > 0)
        change.algorithm = press.make(kNames[random.pick(3)], stiff(random.between(100, 1000), 1 + random.pick(20)));
      if (random.pick(3) == 0) change.force_limit_N = random.between(0.5, 8);
      press.changes.give(std::move(change));
    });
    for (std::size_t i = 300; i < records.size(); ++i) {
      ASSERT_TRUE(records[i].in_contact) << i;
      ASSERT_EQ(records[i].faults & kFadingFaults, 0U) << i;
      ASSERT_LE((force(records[i]) - force(records[i - 1])).norm(), 0.08 + 0.15 * 1000 * depth_m) << i;
    }
  }
}

// In one tick the tool leaps into the ball and new settings come. Nothing is known of how it came there, so it is not
// pushed out: the new algorithm does not go on from the contact of before.
TEST(ServoLoopChanges, AChangeInTheTickOfALeapPushesNobodyOut) {
  class Leaping final : public Device {
   public:
    [[nodiscard]] std::string_view name() const noexcept override { return "leaping"; }
    [[nodiscard]] DeviceLimits limits() const noexcept override { return {.force_limit_N = 5}; }
    [[nodiscard]] bool read(Vec3& position_W) noexcept override {
      ++ticks_;
      position_W = ticks_ <= 300 ? onBall(0, std::min(1e-3, -1e-3 + 1e-5 * ticks_)) : onBall(1.5, 5e-3);
      return true;
    }
    [[nodiscard]] bool leapt() noexcept override { return ticks_ == 301; }
    [[nodiscard]] bool write(const Vec3&) noexcept override { return true; }

   private:
    int ticks_ = 0;
  };
  Press press("hri", stiff(500), pressAndHold(1e-3));
  press.parameters.ticks = 600;
  Leaping device;
  ServoLoop loop(press.parameters, *press.algorithm, device, press.scene.windows, press.scene.tool);
  loop.takeChangesFrom(press.changes);
  const auto records = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
                             const ToolPose& pose = press.scene.tool.latest();
                             if (tick % 16 == 0)
                               press.scene.publish(pose.at_surface ? pose.surface_W : pose.position_W, now_ns);
                             press.scene.windows.confirm(now_ns);
                             if (tick == 300) press.changes.give({.algorithm = press.make("hri", stiff(900))});
                           })
                           .records;
  ASSERT_GT(force(records[299]).norm(), 0.2);
  for (std::size_t tick = 301; tick < records.size(); ++tick) {
    ASSERT_FALSE(records[tick].in_contact) << tick;
    // Until a window has followed the tool, that one is missing is all that is known.
    ASSERT_NE(records[tick].faults & (bit(ServoFault::kInsideObject) | bit(ServoFault::kBeyondWindow)), 0U) << tick;
  }
  EXPECT_TRUE(has(records.back().faults, ServoFault::kInsideObject));
}

// The same for a run that begins inside: no change of the settings gives a force before the tool has been outside.
TEST(ServoLoopChanges, AToolThatStartedInsideStaysWithoutForce) {
  for (const char* name : {"hri", "hri-paper", "blezek"}) {
    Press press("hri", stiff(500),
                SampledPath({0, 0.6, 1.0}, {onBall(0, 4e-3), onBall(0, 3e-3), onBall(0, 3e-3)},
                            SampledPath::Interpolation::kLinear));
    for (const TickRecord& record : press.run([&](std::int64_t tick) {
           if (tick == 200) press.changes.give({.algorithm = press.make(name, stiff(900))});
         })) {
      ASSERT_TRUE(force(record).isZero(0)) << name << " " << record.tick;
    }
  }
}

}  // namespace changes_felt_test
}  // namespace palpate
