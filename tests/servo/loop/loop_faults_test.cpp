// SPDX-License-Identifier: Apache-2.0
// What each fault of clock, engine and device does to the force, in the loop's own code: a steady push of 4 N.
#include <cmath>

#include <gtest/gtest.h>

#include "support/fault_injection.hpp"
#include "support/touch_scene.hpp"

namespace palpate {
namespace loop_faults_test {

class LoopFaults : public testing::Test {
 protected:
  // `ticks` run ticks at 1 kHz; the window is there from tick `first_window` on.
  LoopResult run(int ticks, std::vector<InjectedFault> faults, int first_window = 0) {
    script.faults = std::move(faults);
    WindowStorage storage(ScriptedEngine::kSide * ScriptedEngine::kSide * ScriptedEngine::kSide);
    WindowExchange windows(storage);
    ToolPoseMailbox tool;
    const AnalyticVolume volume = millimetreVolume(ball(Vec3::Constant(8e-3), 5e-3), 16);
    ScriptedEngine engine(script, volume, Vec3::Constant(8e-3));
    SteadyPush push(Vec3(0, 0, 4));
    ScriptedAlgorithm algorithm(script, push);
    parameters.ticks = 0;
    parameters.record_ticks = ticks;
    ServoLoop loop(parameters, algorithm, device, windows, tool);
    if (changes != nullptr) loop.takeChangesFrom(*changes);
    newest_faults.clear();
    clock.before_tick = [&] {
      newest_faults.push_back(loop.newestFaults());
      if (tool.latest().tick >= 0) fastest_m_per_s = std::max(fastest_m_per_s, tool.latest().velocity_W.norm());
      if (script.tick >= first_window && script.tick < ticks) engine.beforeTick(windows, clock.time_ns);
      if (script.tick == ticks - 1) loop.requestStop();
    };
    return loop.runOn(clock);
  }
  static double force(const LoopResult& result, std::size_t tick) { return result.records[tick].force_W[2]; }
  static void expectFault(const LoopResult& result, ServoFault fault, std::size_t first, std::size_t end) {
    for (std::size_t i = 0; i < result.records.size(); ++i) {
      ASSERT_EQ(has(result.records[i].faults, fault), i >= first && i < end) << i;
    }
  }

  LoopParameters parameters = [] {
    LoopParameters p;
    p.safety.fade_s = 0.01;               // 10 ticks
    p.safety.slew_limit_N_per_s = 20000;  // none to speak of
    return p;
  }();
  FaultScript script;
  ScriptedClock clock{script};
  ScriptedDevice device{script, clock, [](int) { return Vec3::Constant(8e-3).eval(); }, 1000};
  ServoChanges* changes = nullptr;
  std::vector<std::uint32_t> newest_faults;  // as another thread would see them before each tick
  double fastest_m_per_s = 0;                // of all velocities that the engine was told
};

TEST_F(LoopFaults, NoneGivesThePush) {
  const LoopResult result = run(50, {});
  ASSERT_EQ(result.records.size(), 50u);
  for (const TickRecord& r : result.records) {
    EXPECT_EQ(r.faults, 0u);
    EXPECT_EQ(r.force_W[2], 4);
    EXPECT_NEAR(r.density, 5e-3, 1e-8);  // at the ball's centre
    EXPECT_EQ(r.lateness_ns, 1000);      // between two looks at the clock
    EXPECT_EQ(r.tick_cost_ns, 1000);
    EXPECT_EQ(r.edit_version, r.tick < 48 ? 0U : 1U);
  }
  EXPECT_EQ(fastest_m_per_s, 0);  // it has been at rest where it was found
}

// What a clock of 32 bits cannot say is said to be the most that it can.
TEST_F(LoopFaults, LatenessAndCostAreThoseOfTheTick) {
  const LoopResult late = run(50, {{Injected::kStallAsleep, 20, 1, 0.05}});
  EXPECT_EQ(late.records[20].lateness_ns, 50'001'000);
  EXPECT_EQ(late.records[20].tick_cost_ns, 1000);
  script = {};
  const LoopResult slow = run(50, {{Injected::kStallInTick, 20, 1, 0.05}, {Injected::kStallInTick, 30, 1, 3}});
  EXPECT_EQ(slow.records[20].lateness_ns, 1000);
  EXPECT_EQ(slow.records[20].tick_cost_ns, 50'001'000);
  EXPECT_EQ(slow.records[30].tick_cost_ns, 2'147'483'647);
}

// A tick that is done in the nanosecond in which the next one is due is in time; one that is done when the one after
// that is due leaves out one. A look at the clock, after waking and when done, takes a microsecond each.
TEST_F(LoopFaults, ATickMayLastUntilTheNextIsDue) {
  const LoopResult punctual = run(50, {{Injected::kStallInTick, 20, 1, 0.000998}});
  expectFault(punctual, ServoFault::kOverrun, 0, 0);
  EXPECT_EQ(punctual.ticks_skipped, 0);
  script = {};
  const LoopResult late = run(50, {{Injected::kStallInTick, 20, 1, 0.001998}});
  expectFault(late, ServoFault::kOverrun, 20, 21);
  EXPECT_EQ(late.records[21].tick, 22);
  EXPECT_EQ(late.ticks_skipped, 1);
}

// A device that states no limit takes whatever limit is asked for.
TEST_F(LoopFaults, AChangedForceLimitIsBoundedByNothingWhereTheDeviceSaysNothing) {
  ServoChanges given;
  given.give({.force_limit_N = 12.0});
  changes = &given;
  device.force_limit_N = 0;
  parameters.safety.force_limit_N = 2;
  const LoopResult result = run(150, {});
  EXPECT_NEAR(force(result, 0), 2 + 10 / 500.0, 1e-12);  // the first tick of EditEase::kTime_s: it grows
  EXPECT_EQ(force(result, 149), 4);
}

// The engine publishes while the servo runs: no window, then at once a fresh one, never a stale one. The clock has run
// for an hour, so an age counted from its zero would be stale.
TEST_F(LoopFaults, TheFirstWindowIsNotStale) {
  const LoopResult result = run(50, {}, 5);
  expectFault(result, ServoFault::kNoWindow, 0, 5);
  expectFault(result, ServoFault::kStaleWindow, 0, 0);
}

// 50 ms late: the device has held 4 N all the while. It lets go, and starts again from nothing.
TEST_F(LoopFaults, AStallAsleepStartsTheForceFromNothing) {
  const LoopResult result = run(50, {{Injected::kStallAsleep, 20, 1, 0.05}});
  expectFault(result, ServoFault::kStall, 20, 21);
  EXPECT_EQ(newest_faults[20], 0U);
  EXPECT_EQ(newest_faults[21] | bit(ServoFault::kOverrun), result.records[20].faults);
  EXPECT_EQ(newest_faults[22], result.records[21].faults);
  EXPECT_EQ(force(result, 19), 4);
  EXPECT_EQ(force(result, 20), 0);
  for (std::size_t i = 1; i <= 10; ++i) EXPECT_NEAR(force(result, 20 + i), 0.4 * static_cast<double>(i), 1e-12);
  EXPECT_GT(result.ticks_skipped, 45);
}

// In the tick itself: that tick's force is for the position that came late; the next tick sees the gap.
TEST_F(LoopFaults, AStallInATickIsSeenInTheNext) {
  const LoopResult result = run(50, {{Injected::kStallInTick, 20, 1, 0.05}});
  EXPECT_TRUE(has(result.records[20].faults, ServoFault::kOverrun));
  expectFault(result, ServoFault::kStall, 21, 22);
  EXPECT_EQ(force(result, 21), 0);
  EXPECT_NEAR(force(result, 26), 2, 1e-12);
}

// Of 1 ms a tick takes 1.5: the next grid point has passed and is left out. One of half a tick leaves none out.
TEST_F(LoopFaults, ATickLongerThanItsPeriodLeavesOutAGridPoint) {
  const LoopResult late = run(50, {{Injected::kStallInTick, 20, 1, 0.0015}});
  expectFault(late, ServoFault::kOverrun, 20, 21);
  EXPECT_EQ(late.records[21].tick, 22);
  EXPECT_EQ(late.ticks_skipped, 1);
  script = {};
  const LoopResult punctual = run(50, {{Injected::kStallInTick, 20, 1, 0.0005}});
  expectFault(punctual, ServoFault::kOverrun, 0, 0);
  EXPECT_EQ(punctual.records[21].tick, 21);
  EXPECT_EQ(punctual.ticks_skipped, 0);
}

TEST_F(LoopFaults, AShortDelayIsNoStall) {
  const LoopResult result = run(50, {{Injected::kStallAsleep, 20, 1, 0.0099}});
  expectFault(result, ServoFault::kStall, 0, 0);
  EXPECT_EQ(force(result, 20), 4);
}

// Positions up to 20 ms old are used; report 20 is the first to be missing, 21 ms of age are reached in tick 40.
TEST_F(LoopFaults, DroppedReportsFadeTheForceUntilOneComes) {
  const LoopResult result = run(100, {{Injected::kDroppedReports, 20, 40}});
  expectFault(result, ServoFault::kDroppedReports, 40, 60);
  EXPECT_EQ(force(result, 39), 4);
  EXPECT_NEAR(force(result, 44), 2, 1e-12);
  EXPECT_EQ(force(result, 49), 0);
  EXPECT_NEAR(force(result, 64), 2, 1e-12);
  EXPECT_EQ(force(result, 69), 4);
}

TEST_F(LoopFaults, AnEngineClockThatStepsAheadFadesTheForceWhileItIsAhead) {
  const LoopResult result = run(100, {{Injected::kEngineClock, 20, 30, 3600}});
  // The last tick: the confirmation goes back to the servo's time.
  expectFault(result, ServoFault::kClockStep, 20, 51);
  EXPECT_EQ(force(result, 30), 0);
  EXPECT_EQ(force(result, 65), 4);
}

TEST_F(LoopFaults, AnEngineClockThatStepsBackLooksStale) {
  const LoopResult result = run(100, {{Injected::kEngineClock, 20, 30, -3600}});
  expectFault(result, ServoFault::kClockStep, 20, 21);
  expectFault(result, ServoFault::kStaleWindow, 20, 50);
  EXPECT_EQ(force(result, 30), 0);
  EXPECT_EQ(force(result, 65), 4);
}

// Back by a second: a step in its tick; the loop then sleeps until its grid is due again, which is a stall.
TEST_F(LoopFaults, AServoClockThatStepsBack) {
  const LoopResult result = run(100, {{Injected::kServoClock, 20, 1, -1}});
  expectFault(result, ServoFault::kClockStep, 20, 21);
  expectFault(result, ServoFault::kStall, 21, 22);
  EXPECT_NEAR(force(result, 20), 3.6, 1e-12);
  EXPECT_EQ(force(result, 21), 0);
  EXPECT_EQ(force(result, 40), 4);
}

// Ahead by a second: it cannot be told from a stall, and the grid points of that second are left out.
TEST_F(LoopFaults, AServoClockThatStepsAheadIsAStall) {
  const LoopResult result = run(100, {{Injected::kServoClock, 20, 1, 1}});
  expectFault(result, ServoFault::kStall, 20, 21);
  expectFault(result, ServoFault::kClockStep, 0, 0);
  EXPECT_GE(result.ticks_skipped, 999);
  EXPECT_EQ(force(result, 20), 0);
  EXPECT_EQ(force(result, 40), 4);
}

// Three writes are refused, while the fade goes on: the device holds 4 N, and then takes 2.8 N.
TEST_F(LoopFaults, AFailedWriteFadesTheNextForce) {
  parameters.safety.slew_limit_N_per_s = 1e5;
  const LoopResult result = run(50, {{Injected::kWriteError, 20, 3}});
  expectFault(result, ServoFault::kDeviceError, 20, 24);
  for (std::size_t i = 19; i < 23; ++i) EXPECT_EQ(force(result, i), 4) << i;
  EXPECT_NEAR(device.written_W[21].z(), 3.6, 1e-12);
  EXPECT_NEAR(force(result, 23), 2.8, 1e-12);
  EXPECT_NEAR(force(result, 24), 3.2, 1e-12);
}

// Refused for longer than the fade: the first force that is taken differs by one slew from the 4 N that the device
// holds, and so does each one after it.
TEST_F(LoopFaults, AfterALongRefusalTheForceFallsAtTheSlewLimit) {
  parameters.safety.slew_limit_N_per_s = 1000;  // 1 N a tick
  const LoopResult result = run(80, {{Injected::kWriteError, 20, 30}});
  for (std::size_t i = 19; i < 50; ++i) EXPECT_EQ(force(result, i), 4) << i;
  for (std::size_t i = 50; i < 53; ++i) EXPECT_NEAR(force(result, i), 53 - static_cast<double>(i), 1e-12) << i;
  EXPECT_EQ(force(result, 70), 4);
  EXPECT_TRUE(result.released);
}

// A run that ends while the device refuses: every offer is one slew below the 4 N that it holds, until it takes them.
// The first of them is made in the last tick's time, so that tick's refusal is met twice.
TEST_F(LoopFaults, TheEndOfARunIsOfferedUntilItIsTaken) {
  parameters.safety.slew_limit_N_per_s = 1000;
  const LoopResult result = run(50, {{Injected::kWriteError, 40, 30}});  // 10 ticks of the run and 20 after it
  EXPECT_TRUE(result.released);
  ASSERT_EQ(device.written_W.size(), 50u + 21 + 4);
  for (std::size_t i = 50; i < 71; ++i) EXPECT_NEAR(device.written_W[i].z(), 3, 1e-12) << i;
  for (std::size_t i = 71; i < 75; ++i) EXPECT_NEAR(device.written_W[i].z(), 74 - static_cast<double>(i), 1e-12) << i;
}

// One that never takes them is given up after a second, and the result says so.
TEST_F(LoopFaults, ADeviceThatRefusesForEverIsGivenUp) {
  const LoopResult result = run(50, {{Injected::kWriteError, 40, 100000}});
  EXPECT_FALSE(result.released);
  EXPECT_EQ(device.written_W.size(), 50u + 1000);
}

// A device of 1.5 N under a scene that allows 8 N, and the controller's share goes with it.
TEST_F(LoopFaults, TheSmallerOfSceneAndDeviceLimitsTheForce) {
  for (const double of_device : {1.5, 8.0}) {
    script = {};
    device.force_limit_N = of_device;
    const LoopResult result = run(20, {});
    EXPECT_NEAR(force(result, 19), std::min(of_device, 4.0), 1e-12);
    EXPECT_EQ(has(result.records[19].faults, ServoFault::kForceLimited), of_device < 4);
  }
}

// A device that cuts to 2.5 N without having said so: what it holds is what is noted and told to the engine.
TEST_F(LoopFaults, WhatTheDeviceHoldsIsNoted) {
  device.cut_N = 2.5;
  const LoopResult result = run(20, {});
  EXPECT_NEAR(device.written_W[10].z(), 4, 1e-12);
  EXPECT_NEAR(force(result, 10), 2.5, 1e-12);
}

// A release that takes longer than a refusing device is given, with every write taken: it is no refusal.
TEST_F(LoopFaults, ALongReleaseIsNotGivenUp) {
  parameters.safety.slew_limit_N_per_s = 1;  // 1 mN a tick
  const LoopResult result = run(1500, {});
  EXPECT_NEAR(force(result, 1499), 1.5, 1e-9);
  EXPECT_TRUE(result.released);
  EXPECT_TRUE(device.held_W.back().isZero(0));
  EXPECT_NEAR(static_cast<double>(device.written_W.size()), 3000, 1);  // sums of 1 mN are rounded
}

// Takes every write and says that it holds 1 N whatever it was given: the run ends all the same.
class StuckDevice : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "stuck"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    position_W.setZero();
    return true;
  }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return ++writes > 0; }
  [[nodiscard]] Vec3 held(const Vec3&) const noexcept override { return Vec3(0, 0, 1); }
  int writes = 0;
};

TEST(LoopRelease, ADeviceThatNeverHoldsLessDoesNotKeepTheRun) {
  StuckDevice device;
  SteadyPush push(Vec3::Zero());
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 10;
  ServoLoop loop(p, push, device, windows, tool);
  EXPECT_FALSE(loop.runSimulated().released);
  EXPECT_LE(device.writes, 10 + 100 + 10 + 1);  // of the run; of the fade; what the slew may ask for more
}

// Writes of the release are a period apart, as ticks are: a device that refuses them is asked for its patience's time.
TEST(LoopRelease, TakesAPeriodForEachWrite) {
  class Refusing final : public StuckDevice {
   public:
    void elapse(int ticks) noexcept override { elapsed += ticks; }
    [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
    int elapsed = 0;
  } device;
  FaultScript script;
  ScriptedClock clock(script);
  SteadyPush push(Vec3::Zero());
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 10;
  ServoLoop loop(p, push, device, windows, tool);
  const std::int64_t begin_ns = clock.time_ns;
  EXPECT_FALSE(loop.runOn(clock).released);
  // Ten ticks and a second of patience at 1 kHz.
  EXPECT_NEAR(static_cast<double>(clock.time_ns - begin_ns) * 1e-9, 0.010 + 1, 0.005);
  EXPECT_EQ(device.elapsed, 9 + 1000);
}

// Of a run of so many ticks no more are left out than it has: one that stalls for 50 ms after its 45th of 50.
TEST(LoopGrid, NoTickIsLeftOutBehindTheEndOfTheRun) {
  FaultScript script;
  script.faults = {{Injected::kStallInTick, 45, 1, 0.05}};
  ScriptedClock clock(script);
  ScriptedDevice device(
      script, clock, [](int) { return Vec3::Zero().eval(); }, 1000);
  SteadyPush push(Vec3::Zero());
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 50;
  ServoLoop loop(p, push, device, windows, tool);
  const LoopResult result = loop.runOn(clock);
  EXPECT_EQ(result.ticks_run, 46);
  EXPECT_EQ(result.ticks_skipped, 4);
}

// Before its first tick the algorithm is put where the device is.
TEST(LoopStart, PutsTheAlgorithmWhereTheDeviceIs) {
  class Remembering final : public Algorithm {
   public:
    void reset(const Vec3& hip_W) noexcept override { reset_W = hip_W; }
    void tick(const TickInput&, TickOutput& out) noexcept override { out = TickOutput{}; }
    Vec3 reset_W = Vec3::Constant(9);
  } algorithm;
  StuckDevice device;
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 1;
  const ServoLoop loop(p, algorithm, device, windows, tool);
  EXPECT_EQ(algorithm.reset_W, Vec3(Vec3::Zero()));
}

// A person's tool that begins inside of an object, or is there at once, after it has touched nothing for a while: it is
// not pushed out, as in any start.
TEST(LoopStart, AToolThatIsInsideAnObjectIsNotPushed) {
  class Placed final : public StuckDevice {
   public:
    [[nodiscard]] DeviceLimits limits() const noexcept override {
      return {.force_limit_N = 5, .is_held = true, .motion = kHandMotion};
    }
    [[nodiscard]] bool read(Vec3& position_W) noexcept override {
      position_W = at_W;
      return true;
    }
    [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override { return force_W; }
    Vec3 at_W = Vec3::Zero();
  };
  for (const char* name : {"hri", "blezek", "implicit"}) {
    for (const bool jumps : {false, true}) {
      SCOPED_TRACE(std::string(name) + (jumps ? ", jumps in" : ", begins inside"));
      TouchScene scene(0.2, name);
      Placed device;
      device.at_W = TouchScene::above(jumps ? 14e-3 : -10e-3);
      LoopParameters p;
      p.ticks = 200;
      ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
      const LoopResult result = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
        if (tick % 16 == 0) scene.publish(device.at_W, now_ns);
        scene.windows.confirm(now_ns);
        if (tick == 60) device.at_W = TouchScene::above(-10e-3);
        if (tick == 60) scene.publish(device.at_W, now_ns);
      });
      for (const TickRecord& record : result.records) {
        ASSERT_EQ(asVec3(record.force_W).norm(), 0) << record.tick;
        ASSERT_FALSE(record.in_contact) << record.tick;
      }
      EXPECT_TRUE(has(result.records.back().faults, ServoFault::kInsideObject));
    }
  }
}

// The device asks for 1 N a tick, the scene allows more; or the other way round. The smaller counts.
TEST_F(LoopFaults, TheSmallerOfSceneAndDeviceLimitsTheSlew) {
  for (const double of_scene : {5000.0, 500.0}) {
    SCOPED_TRACE(of_scene);
    script = {};
    device.slew_limit_N_per_s = 1000;
    device.written_W.clear();
    parameters.safety.slew_limit_N_per_s = of_scene;
    const LoopResult result = run(20, {});
    const double step_N = std::min(of_scene, 1000.0) / 1000;
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_NEAR(force(result, i), std::min(4.0, step_N * double(i + 1)), 1e-12) << i;
  }
}

// 4 N: the run's end takes the fade's ten writes, as a fault would, or the 41 that a slew of 0.1 N a tick asks for.
TEST_F(LoopFaults, TheEndOfARunFades) {
  for (const double slew_N_per_s : {20000.0, 100.0}) {
    parameters.safety.slew_limit_N_per_s = slew_N_per_s;
    device.written_W.clear();
    script.tick = -1;
    const LoopResult result = run(50, {});
    ASSERT_EQ(result.records.size(), 50u);
    EXPECT_TRUE(result.released);
    EXPECT_NEAR(force(result, 49), 4, 1e-9);
    const std::size_t ticks = slew_N_per_s > 1000 ? 10 : 41;
    const std::vector<Vec3>& written_W = device.written_W;
    ASSERT_EQ(written_W.size(), 50 + ticks);
    for (std::size_t i = 1; i <= ticks; ++i)
      EXPECT_NEAR(written_W[49 + i].z(), 4 * (1 - static_cast<double>(i) / static_cast<double>(ticks)), 1e-9) << i;
  }
}

// A tool that is somewhere else at once: one tick counts as no answer, then it begins anew there. What is held fades in
// a straight line through both, and comes back from nothing: within the fade, or of a held device as at the start.
TEST_F(LoopFaults, AtANewPlaceTheForceComesBackFromNothing) {
  for (const bool is_held : {false, true}) {
    device.is_held = is_held;
    script.tick = -1;
    const LoopResult result = run(2400, {{Injected::kWildPosition, 1200, 10000, 5}});
    expectFault(result, ServoFault::kDeviceError, 1200, 1201);
    EXPECT_EQ(force(result, 1199), 4);
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_NEAR(force(result, 1200 + i), 4 - 0.4 * (static_cast<double>(i) + 1), 1e-12) << i;
    for (std::size_t i = 1; 1209 + i < 2400; ++i) {
      const double ticks = static_cast<double>(i);
      const double share = std::min(1.0, ticks / 10) * (is_held ? std::min(1.0, ticks / 1000) : 1);
      ASSERT_NEAR(force(result, 1209 + i), 4 * share, 1e-12) << i;
    }
  }
}

// Of a device that a person holds the force begins at nothing, also after the device was away; its clutch is no start.
TEST_F(LoopFaults, TheForceOfAHeldDeviceGrowsOverASecond) {
  device.is_held = true;
  for (const ForceOff why : {ForceOff::kUncalibrated, ForceOff::kClutched}) {
    device.why_off = why;
    script.tick = -1;
    const LoopResult result = run(2600, {{Injected::kForceOff, 1200, 50}});
    for (std::size_t i = 0; i < 1200; ++i)
      ASSERT_NEAR(force(result, i), 4 * std::min(1.0, (static_cast<double>(i) + 1) / 1000), 1e-12) << i;
    for (std::size_t i = 1200; i < 1250; ++i) ASSERT_EQ(force(result, i), 0) << i;
    const double back_ticks = why == ForceOff::kClutched ? 1 : 1000;
    for (std::size_t i = 1250; i < 2600; ++i) {
      const double ticks = static_cast<double>(i) - 1249;
      ASSERT_NEAR(force(result, i), 4 * std::min(1.0, ticks / 10) * std::min(1.0, ticks / back_ticks), 1e-12) << i;
    }
  }
}

// At 3 kHz a period is no whole number of nanoseconds: after 6 s every tick is still due within one of k / rate, where
// a rounded period would have drifted by 6 us.
class NotingClock final : public ServoClock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return time_ns_; }
  void sleepUntil(std::int64_t due_ns) noexcept override {
    time_ns_ = due_ns;
    dues_ns.push_back(due_ns);
  }
  std::vector<std::int64_t> dues_ns;

 private:
  std::int64_t time_ns_ = 0;
};

TEST(LoopGrid, TicksAreDueAtMultiplesOfThePeriodWithoutDrift) {
  NotingClock clock;
  FaultScript script;
  ScriptedClock unused(script);
  ScriptedDevice device(
      script, unused, [](int) { return Vec3::Zero().eval(); }, 3000);
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  SteadyPush push(Vec3::Zero());
  LoopParameters p;
  p.rate_hz = 3000;
  p.ticks = 18000;
  ServoLoop loop(p, push, device, windows, tool);
  static_cast<void>(loop.runOn(clock));
  ASSERT_EQ(clock.dues_ns.size(), 18000u);
  for (std::size_t k = 0; k < 18000; ++k) {
    const double since_ns = static_cast<double>(clock.dues_ns[k] - clock.dues_ns[0]);
    ASSERT_NEAR(since_ns, static_cast<double>(k) * 1e9 / 3000, 1) << k;
  }
}

// A tool that trembles by less than its encoders' resolution, 1 um: an estimate that knows it says that the tool is at
// rest, to a step over its window of 16 ticks; the bare difference would be 0.8 um a tick.
TEST(LoopReports, TheVelocityKnowsTheDevicesResolution) {
  FaultScript script;
  ScriptedClock clock(script);
  ScriptedDevice device(
      script, clock, [](int tick) { return Vec3(tick % 2 == 0 ? 0.4e-6 : -0.4e-6, 0, 0); }, 1000);
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  SteadyPush push(Vec3::Zero());
  LoopParameters p;
  p.ticks = 0;
  p.record_ticks = 100;
  p.velocity.name = "foaw";
  ServoLoop loop(p, push, device, windows, tool);
  int looks = 0;
  clock.before_tick = [&] {
    if (script.tick == 99) loop.requestStop();
    const ToolPose& pose = tool.latest();
    if (pose.tick < 20) return;
    ++looks;
    EXPECT_LE(std::abs(pose.velocity_W.x()), 0.8e-6 / 15e-3 + 1e-12) << pose.tick;
  };
  static_cast<void>(loop.runOn(clock));
  EXPECT_GT(looks, 50);
}

// Pushed along by 4 N the tool gets energy that nobody took: the controller acts. While a fault takes the force away it
// does not, and says so.
TEST(LoopReports, TheControllerIsNotNotedWhileAFaultFadesTheForce) {
  FaultScript script;
  script.faults = {{Injected::kNanForce, 40, 20}};
  ScriptedClock clock(script);
  ScriptedDevice device(
      script, clock, [](int tick) { return Vec3(8e-3, 8e-3, 8e-3 + 2e-5 * tick); }, 1000);
  const AnalyticVolume volume = millimetreVolume(ball(Vec3::Constant(8e-3), 5e-3), 16);
  ScriptedEngine engine(script, volume, Vec3::Constant(8e-3));
  WindowStorage storage(ScriptedEngine::kSide * ScriptedEngine::kSide * ScriptedEngine::kSide);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  SteadyPush push(Vec3(0, 0, 4));
  ScriptedAlgorithm algorithm(script, push);
  LoopParameters p;
  p.ticks = 0;
  p.record_ticks = 100;
  p.passivity.control = true;
  ServoLoop loop(p, algorithm, device, windows, tool);
  clock.before_tick = [&] {
    engine.beforeTick(windows, clock.time_ns);
    if (script.tick == 99) loop.requestStop();
  };
  const LoopResult result = loop.runOn(clock);
  ASSERT_EQ(result.records.size(), 100u);
  for (std::size_t i = 10; i < 100; ++i) EXPECT_EQ(result.records[i].damped, i < 40 || i >= 60) << i;
}

// A device that reports every fourth tick, as a 1 kHz device under a 4 kHz servo: the velocity is that of the reports.
TEST(LoopReports, ARepeatedPositionTellsNothingOfTheVelocity) {
  FaultScript script;
  ScriptedClock clock(script);
  for (int tick = 1; tick < 100; tick += 4) script.faults.push_back({Injected::kDroppedReports, tick, 3});
  ScriptedDevice device(
      script, clock, [](int tick) { return Vec3(1e-4 * tick, 0, 0); }, 1000);
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  SteadyPush push(Vec3::Zero());
  LoopParameters p;
  p.ticks = 0;
  p.record_ticks = 100;
  p.velocity.cutoff_hz = 0;
  ServoLoop loop(p, push, device, windows, tool);
  clock.before_tick = [&] {
    if (script.tick == 99) loop.requestStop();
    const ToolPose& pose = tool.latest();
    if (pose.tick >= 4) {
      EXPECT_NEAR(pose.velocity_W.x(), 0.1, 1e-12) << pose.tick;
    }
  };
  static_cast<void>(loop.runOn(clock));
}

}  // namespace loop_faults_test
}  // namespace palpate
