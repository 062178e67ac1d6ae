// SPDX-License-Identifier: Apache-2.0
// The servo outlives an engine, and takes up its contact with the next one from no force.
#include "servo/loop/servo_links.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "changing_press.hpp"
#include "servo/safety/faults.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace servo_links_test {

// A hand that presses while the first engine dies at kDies and the next one begins at `begins`.
struct Takeover {
  static constexpr std::int64_t kDies = 300;
  std::string algorithm = "hri";
  double depth_m = 1e-3;
  std::int64_t begins = 1200;
  std::int64_t works_from = 1210;  // the next engine's first window
  std::int64_t withdrawn_at = -1;
  double limit_N = 5;
  bool lies = false;         // the first engine's last word is of a time that has not come
  bool left_one = false;     // it left a change that the servo has not taken
  bool next_limits = false;  // the next engine gives a change before its first window

  std::vector<TickRecord> run() {
    const AlgorithmParameters parameters{.stiffness_N_per_m = 400, .damping_Ns_per_m = 0};
    Press press(algorithm, parameters,
                SampledPath({0, 0.1, 2.5}, {onBall(0, -1e-3), onBall(0, depth_m), onBall(0.05, depth_m)},
                            SampledPath::Interpolation::kLinear));
    NextEngine next(press.scene, 100);
    ServoLink link{.windows = &next.servos_windows,
                   .tool = &next.servos_tool,
                   .algorithm = press.make(algorithm, parameters),
                   .force_limit_N = limit_N};
    const Algorithm* const given = link.algorithm.get();
    SimulatedDevice device(press.device_parameters, press.path, press.parameters.rate_hz);
    ServoLoop loop(press.parameters, *press.algorithm, device, press.scene.windows, press.scene.tool);
    ServoLinks links;
    loop.takeLinksFrom(links);
    loop.takeChangesFrom(press.changes);
    std::vector<TickRecord> records =
        loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
              if (tick < kDies) {
                const ToolPose& pose = press.scene.tool.latest();
                if (tick % 16 == 0) press.scene.publish(pose.at_surface ? pose.surface_W : pose.position_W, now_ns);
                press.scene.windows.confirm(now_ns);
              }
              if (lies && tick == kDies) press.scene.windows.confirm(now_ns + 1'000'000'000'000);
              if (left_one && tick == begins) {
                press.changes.give({.force_limit_N = 0.05});
                press.changes.withdraw();
              }
              if (next_limits && tick == begins + 2) press.changes.give({.force_limit_N = 0.05});
              if (tick == begins) links.give(link);
              if (tick == begins + 1) was_heard = links.state() == ServoLinks::State::kHeard;
              if (tick == withdrawn_at) links.withdraw();
              if (tick >= works_from && (tick - works_from) % 16 == 0) heard = next.publish(now_ns) && heard;
              if (tick >= works_from) next.windows.confirm(now_ns);
            })
            .records;
    state = links.state();
    is_given_back = link.algorithm.get() != given;
    return records;
  }
  ServoLinks::State state = ServoLinks::State::kNone;
  bool heard = true, was_heard = false, is_given_back = false;
};

double newtons(const TickRecord& record) {
  return force(record).norm();
}

// Whatever algorithm, however deep: there is no force before the next engine's first window, then it grows from nothing
// by the fade's share of the whole in each tick, and the contact is what it was.
TEST(ServoLinks, AContactGoesOnWithTheNextEngineFromNoForce) {
  Seeded random(11);
  for (const char* algorithm : {"hri", "hri-paper", "blezek", "implicit"}) {
    for (int i = 0; i < 6; ++i) {
      Takeover takeover{.algorithm = algorithm, .depth_m = random.logBetween(2e-4, 1.5e-3)};
      takeover.begins = 1100 + random.pick(300);
      takeover.works_from = takeover.begins + 1 + random.pick(60);
      SCOPED_TRACE(fmt::format("{} {} m, {}, {}", algorithm, takeover.depth_m, takeover.begins, takeover.works_from));
      const std::vector<TickRecord> records = takeover.run();
      ASSERT_EQ(records.size(), 2500U);
      EXPECT_TRUE(takeover.heard);
      EXPECT_TRUE(takeover.was_heard);
      EXPECT_EQ(takeover.state, ServoLinks::State::kDone);
      EXPECT_TRUE(takeover.is_given_back);
      const auto at = static_cast<std::size_t>(takeover.works_from);
      const double before_N = newtons(records[Takeover::kDies - 1]);
      ASSERT_GT(before_N, 0.04);
      EXPECT_EQ(newtons(records[at - 1]), 0);
      EXPECT_TRUE(has(records[at - 1].faults, ServoFault::kStaleWindow));
      EXPECT_EQ(records[at - 1].window_version, records[Takeover::kDies].window_version);
      EXPECT_EQ(records[at].window_version, 100U);
      const double fade_ticks = 1000 * SafetyParameters{}.fade_s;
      for (std::size_t tick = at; tick < records.size(); ++tick) {
        ASSERT_EQ(records[tick].faults, 0U) << tick;
        ASSERT_TRUE(records[tick].in_contact) << tick;
        // By its share of a force limit, at most: |force| <= limit * authority.
        ASSERT_LE(newtons(records[tick]), takeover.limit_N * static_cast<double>(tick - at + 1) / fade_ticks + 1e-12);
      }
      EXPECT_NEAR(newtons(records.back()), before_N, 0.05 * before_N + 0.01);
    }
  }
}

// One that comes at once, while the first one's windows still count: no jump, and no fault.
TEST(ServoLinks, AQuickEngineIsNotFelt) {
  Takeover takeover{.begins = 310, .works_from = 315};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_EQ(takeover.state, ServoLinks::State::kDone);
  for (std::size_t tick = 150; tick < records.size(); ++tick) {
    ASSERT_EQ(records[tick].faults, 0U) << tick;
    ASSERT_LT(std::abs(newtons(records[tick]) - newtons(records[tick - 1])), 0.02) << tick;
  }
  EXPECT_GT(newtons(records.back()), 0.3);
}

// An engine that never publishes a window leaves the servo where it was, and can be given up.
TEST(ServoLinks, AnEngineThatDiesBeforeItsFirstWindowIsLeft) {
  Takeover takeover{.begins = 1000, .works_from = 9000, .withdrawn_at = 1500};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_EQ(takeover.state, ServoLinks::State::kNone);
  EXPECT_FALSE(takeover.is_given_back);
  for (std::size_t tick = 1000; tick < records.size(); ++tick) {
    ASSERT_EQ(newtons(records[tick]), 0) << tick;
    ASSERT_EQ(records[tick].window_version, records[999].window_version) << tick;
  }
}

TEST(ServoLinks, TheNextEnginesForceLimitHolds) {
  Takeover takeover{.depth_m = 1.5e-3, .limit_N = 0.2};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_GT(newtons(records[Takeover::kDies]), 0.5);
  for (std::size_t tick = 1300; tick < records.size(); ++tick) ASSERT_LE(newtons(records[tick]), 0.2 + 1e-12);
  EXPECT_NEAR(newtons(records.back()), 0.2, 1e-3);
}

// What the first engine said of the time is nothing to hold the next one's words against.
TEST(ServoLinks, TheNextEnginesTimeCounts) {
  Takeover takeover{.lies = true};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_EQ(takeover.state, ServoLinks::State::kDone);
  EXPECT_TRUE(has(records[Takeover::kDies + 1].faults, ServoFault::kClockStep));
  for (auto tick = static_cast<std::size_t>(takeover.works_from); tick < records.size(); ++tick)
    ASSERT_EQ(records[tick].faults, 0U) << tick;
}

// Nor is a change that the first one gave and the servo had not taken.
TEST(ServoLinks, AChangeThatWasLeftIsDropped) {
  Takeover takeover{.left_one = true};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_GT(newtons(records.back()), 0.3);
}

// What the next engine says before its first window holds with its windows.
TEST(ServoLinks, AChangeOfTheNextEngineWaitsForItsWindows) {
  Takeover takeover{.next_limits = true};
  const std::vector<TickRecord> records = takeover.run();
  EXPECT_EQ(takeover.state, ServoLinks::State::kDone);
  EXPECT_NEAR(newtons(records.back()), 0.05, 1e-3);
}

TEST(ServoLinks, AreWithdrawnOnlyBeforeTheyAreDone) {
  ServoLinks links;
  ServoLink link;
  EXPECT_EQ(links.offered(), nullptr);
  links.withdraw();
  EXPECT_EQ(links.state(), ServoLinks::State::kNone);
  links.give(link);
  EXPECT_EQ(links.offered(), &link);
  links.withdraw();
  EXPECT_EQ(links.state(), ServoLinks::State::kWithdrawn);
  links.heard();  // of a tick that had begun
  EXPECT_EQ(links.state(), ServoLinks::State::kWithdrawn);
  EXPECT_EQ(links.offered(), nullptr);
  EXPECT_EQ(links.state(), ServoLinks::State::kNone);
  links.give(link);
  links.done();
  links.withdraw();  // too late
  EXPECT_EQ(links.state(), ServoLinks::State::kDone);
}

}  // namespace servo_links_test
}  // namespace palpate
