// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/servo_loop.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/run_figures.hpp"
#include "support/touch_scene.hpp"

namespace palpate {
namespace servo_loop_test {

LoopParameters simulated(std::int64_t ticks, double rate_hz = 1000) {
  LoopParameters p;
  p.ticks = ticks;
  p.rate_hz = rate_hz;
  return p;
}

// The engine in step: a window every 16 ticks around the newest pose, a heartbeat in each.
LoopResult runInStep(std::string_view algorithm, Hand hand) {
  TouchScene scene(0.4, algorithm);
  SimulatedDeviceParameters device_parameters;
  device_parameters.hand = hand;
  device_parameters.encoder_resolution_m = 1e-6;
  SimulatedDevice device(device_parameters, scene.path, 1000);
  ServoLoop loop(simulated(400), *scene.algorithm, device, scene.windows, scene.tool);
  return loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
    if (tick % 16 == 0) scene.publish(scene.tool.latest().position_W, now_ns);
    scene.windows.confirm(now_ns);
  });
}

TEST(ServoLoopSimulated, TwoRunsAreEqualByteForByte) {
  for (const AlgorithmEntry& entry : algorithms()) {
    const LoopResult a = runInStep(entry.name, Hand::kSpring);
    const LoopResult b = runInStep(entry.name, Hand::kSpring);
    ASSERT_EQ(a.records.size(), 400u);
    ASSERT_EQ(b.records.size(), 400u);
    EXPECT_GT(computeFigures(a.records, 1000).contact_ticks, 200) << entry.name;
    EXPECT_EQ(std::memcmp(a.records.data(), b.records.data(), a.records.size() * sizeof(TickRecord)), 0);
  }
}

TEST(ServoLoopSimulated, RecordsTellWhatWasFelt) {
  const LoopResult run = runInStep("hri", Hand::kRigid);
  EXPECT_EQ(run.ticks_run, 400);
  EXPECT_EQ(run.ticks_skipped, 0);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const TickRecord& r = run.records[i];
    ASSERT_EQ(r.tick, static_cast<std::int64_t>(i));
    ASSERT_DOUBLE_EQ(r.time_s, static_cast<double>(i) / 1000);
    ASSERT_EQ(r.faults, 0u);
    ASSERT_EQ(r.tick_cost_ns, 0);
    ASSERT_EQ(r.lateness_ns, 0);
    ASSERT_EQ(r.window_version, 1 + i / 16);
    ASSERT_EQ(r.window_age_ns, static_cast<std::int64_t>(i % 16) * 1'000'000);
    ASSERT_EQ(r.density > 0, r.in_contact) << i;
    const Vec3 force_W(r.force_W[0], r.force_W[1], r.force_W[2]);
    ASSERT_TRUE(r.in_contact || force_W.isZero(0));
  }
  const RunFigures s = computeFigures(run.records, 1000);
  EXPECT_EQ(s.touches, 1);
  EXPECT_EQ(s.plane_age_max_ticks, AlgorithmParameters{}.plane_renewal_ticks - 1);
  // The path's own greatest depth. Samples of 1 mm put the surface 0.012 mm off at most (h^2 / 4 R), a plane of four
  // ticks at 15 mm/s another 1e-7 m ((v n T)^2 / 2 R), encoders 1e-6 m.
  const TouchScene scene(0.4);
  double deepest_m = 0;
  for (int tick = 0; tick < 400; ++tick) {
    deepest_m = std::max(deepest_m, 20e-3 - (scene.path.position(tick * 1e-3) - Vec3::Constant(31.3e-3)).norm());
  }
  EXPECT_NEAR(s.depth_m.max, deepest_m, 0.015e-3);
}

TEST(ServoLoopSimulated, TheEngineSeesTheToolOfTheLastTick) {
  TouchScene scene;
  SimulatedDevice device({}, scene.path, 1000);
  ServoLoop loop(simulated(5), *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t) {
    const ToolPose& pose = scene.tool.latest();
    EXPECT_EQ(pose.tick, tick - 1);
    EXPECT_EQ(pose.time_ns, std::max<std::int64_t>(0, tick - 1) * 1'000'000);
    EXPECT_EQ(pose.window_version, 0U);
    EXPECT_EQ(pose.position_W, scene.path.position(tick <= 0 ? 0 : static_cast<double>(tick - 1) / 1000));
  });
  EXPECT_TRUE(has(run.records[0].faults, ServoFault::kNoWindow));
  EXPECT_TRUE(std::isnan(run.records[0].density));
  EXPECT_EQ(run.records[4].window_age_ns, 0);  // of no window
}

// What the engine hears of the contact is what the records say of the tick before: the force behind the gate's limit.
TEST(ServoLoopSimulated, TheEngineSeesNormalAndForceOfTheLastTick) {
  TouchScene scene(0.4);
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(400);
  p.safety.force_limit_N = 0.3;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  std::vector<ToolPose> poses;
  const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
    poses.push_back(scene.tool.latest());
    if (tick % 50 == 0) scene.publish(poses.back().position_W, now_ns);
    scene.windows.confirm(now_ns);
  });
  int touching = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].normal_W, Vec3(run.records[i - 1].normal_W)) << i;
    EXPECT_EQ(poses[i].force_W, Vec3(run.records[i - 1].force_W)) << i;
    EXPECT_EQ(poses[i].window_version, run.records[i - 1].window_version) << i;
    EXPECT_EQ(poses[i].at_surface, run.records[i - 1].in_contact) << i;
    if (poses[i].at_surface) {
      EXPECT_LT((poses[i].surface_W - surfacePointOf(run.records[i - 1])).norm(), 1e-15) << i;
    }
    touching += poses[i].force_W.dot(poses[i].normal_W) > 0.1 ? 1 : 0;
  }
  EXPECT_GT(touching, 50);
}

TEST(ServoLoopSimulated, AnEngineThatStopsConfirmingIsStaleAndTheForceFades) {
  TouchScene scene(0.2);
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(400);
  p.safety.stale_window_s = 0.1;
  p.safety.fade_s = 0.05;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
    if (tick == 0) scene.publish(scene.tool.latest().position_W, now_ns);
    if (tick <= 200) scene.windows.confirm(now_ns);
  });
  for (const TickRecord& r : run.records) ASSERT_EQ(has(r.faults, ServoFault::kStaleWindow), r.tick > 300) << r.tick;
  const auto force = [&](std::size_t tick) {
    return std::hypot(run.records[tick].force_W[0], run.records[tick].force_W[2]);
  };
  EXPECT_GT(force(300), 0.1);
  EXPECT_NEAR(force(325), 0.5 * force(300), 1e-9);
  EXPECT_EQ(force(350), 0);
}

TEST(ServoLoopSimulated, KeepsTheNewestRecordsWhenAskedForFewer) {
  TouchScene scene;
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(0);
  p.record_ticks = 7;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t) {
    if (tick == 19) loop.requestStop();
  });
  EXPECT_EQ(run.ticks_run, 20);
  ASSERT_EQ(run.records.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(run.records[i].tick, 13 + static_cast<std::int64_t>(i));
}

// A device that stops answering, or takes no force, from one tick to another.
class FailingDevice final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "failing"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {8, 0}; }
  void elapse(int ticks) noexcept override { tick += ticks; }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    if (tick >= read_fails_from && tick < read_fails_to) return false;
    position_W = tick < 2 ? TouchScene::above(1e-3) : TouchScene::above(-1e-3);
    return true;
  }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    last_W = force_W;
    return tick != write_fails_at;
  }
  int tick = 0, read_fails_from = -1, read_fails_to = -1, write_fails_at = -1;
  Vec3 last_W = Vec3::Zero();
};

TEST(ServoLoopSimulated, ADeviceThatDoesNotAnswerGetsAFadingForceAndComesBack) {
  TouchScene scene;
  FailingDevice device;
  device.read_fails_from = 50;
  device.read_fails_to = 100;
  LoopParameters p = simulated(200);
  p.safety.fade_s = 0.02;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
    if (tick == 0) scene.publish(TouchScene::above(0), now_ns);
    // The engine goes on around what was touched last.
    EXPECT_EQ(scene.tool.latest().at_surface, tick > 2) << tick;
  });
  // Where it was seen last.
  EXPECT_EQ(asVec3(run.records[75].hip_W), TouchScene::above(-1e-3));
  EXPECT_EQ(asVec3(run.records[75].vhip_W), TouchScene::above(-1e-3));
  const auto force = [&](std::size_t tick) { return run.records[tick].force_W[2]; };
  for (const TickRecord& r : run.records) {
    ASSERT_EQ(has(r.faults, ServoFault::kDeviceError), r.tick >= 50 && r.tick < 100) << r.tick;
  }
  EXPECT_GT(force(49), 0.1);
  EXPECT_LT(force(50), force(49));
  EXPECT_EQ(force(69), 0);
  EXPECT_EQ(force(99), 0);
  EXPECT_GT(force(100), 0);
  EXPECT_LT(force(100), force(49));
  EXPECT_NEAR(force(125), force(49), 1e-3);
  EXPECT_TRUE(device.last_W.isZero(0));  // at the end of a run
}

// Pressed on one pole of a ball, the tool is put before the other one, and then below it; every algorithm has the ball
// between the two places in its window. It feels nothing of the ball's inside: the contact is over within the tick, and
// the force with the slew. Then it feels the other pole. A tool that goes the same way with a step of its path is
// caught in the ball.
TEST(ServoLoopSimulated, AToolThatLeapsFeelsNothingInBetween) {
  const Vec3 middle_W = Vec3::Constant(31.3e-3);
  for (const AlgorithmEntry& entry : algorithms()) {
    TouchScene scene(0.4, entry.name);
    scene.volume = millimetreVolume(ball(middle_W, 8e-3));
    scene.algorithm = makeFor(entry.name, {}, scene.volume, 4e-3);
    PointerPath path(middle_W + Vec3(0, 0, 10e-3));
    PointerAimBlock aims;
    PointerAim pointer(aims);
    path.follow(aims);
    SimulatedDevice device({}, path, 1000);
    ServoLoop loop(simulated(600), *scene.algorithm, device, scene.windows, scene.tool);
    std::vector<std::uint32_t> leaps;
    const LoopResult run = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
      if (tick == 0) scene.publish(middle_W, now_ns);  // the whole ball and both places
      scene.windows.confirm(now_ns);
      leaps.push_back(scene.tool.latest().leaps);
      if (tick == 10) pointer.aim(Vec3(middle_W + Vec3(0, 0, 7e-3)));
      if (tick == 300) pointer.aim(PointerTarget(middle_W - Vec3(0, 0, 7e-3), middle_W - Vec3(0, 0, 10e-3)));
    });
    EXPECT_EQ(leaps[300], 0U) << entry.name;
    EXPECT_EQ(leaps.back(), 1U) << entry.name;
    const auto at = [&](std::size_t tick) -> const TickRecord& { return run.records[tick]; };
    EXPECT_GT(at(299).force_W[2], 0.1) << entry.name;
    EXPECT_LT(at(599).force_W[2], -0.1) << entry.name;
    for (std::size_t tick = 300; tick < 600; ++tick) {
      const Vec3 hip_W = asVec3(at(tick).hip_W), vhip_W = asVec3(at(tick).vhip_W);
      EXPECT_TRUE(tick != 300 || hip_W == middle_W - Vec3(0, 0, 10e-3)) << entry.name;
      EXPECT_FALSE(at(tick).in_contact && (hip_W - middle_W).norm() > 8.5e-3) << entry.name << ' ' << tick;
      EXPECT_LE((hip_W - vhip_W).norm(), 1.5e-3) << entry.name << ' ' << tick;
      EXPECT_FALSE(has(at(tick).faults, ServoFault::kDeviceError)) << entry.name << ' ' << tick;
    }
  }
}

TEST(ServoLoopSimulated, AFailedWriteIsFlagged) {
  TouchScene scene;
  FailingDevice device;
  device.write_fails_at = 10;
  ServoLoop loop(simulated(20), *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = loop.runSimulated();
  EXPECT_TRUE(has(run.records[10].faults, ServoFault::kDeviceError));
  EXPECT_FALSE(has(run.records[9].faults, ServoFault::kDeviceError));
}

TEST(ServoLoop, RefusesParametersAndADeviceWithoutPosition) {
  TouchScene scene;
  FailingDevice device;
  const auto refused = [&](auto change) {
    LoopParameters p;
    change(p);
    EXPECT_THROW(ServoLoop(p, *scene.algorithm, device, scene.windows, scene.tool), Error);
  };
  refused([](LoopParameters& p) { p.rate_hz = 0.5; });
  refused([](LoopParameters& p) { p.rate_hz = 20001; });
  refused([](LoopParameters& p) { p.rate_hz = NAN; });
  refused([](LoopParameters& p) { p.ticks = -1; });
  refused([](LoopParameters& p) { p.ticks = 0; });
  refused([](LoopParameters& p) { p.record_ticks = -2; });
  refused([](LoopParameters& p) { p.priority = 0; });
  refused([](LoopParameters& p) { p.priority = 100; });
  refused([](LoopParameters& p) { p.safety.force_limit_N = 0; });
  device.read_fails_from = 0;
  device.read_fails_to = 10;
  refused([](LoopParameters&) {});
}

TEST(ServoLoop, TakesTheEndsOfTheRanges) {
  TouchScene scene;
  FailingDevice device;
  for (const int priority : {1, 99}) {
    LoopParameters p;
    p.rate_hz = priority == 1 ? 1 : 20000;
    p.priority = priority;
    EXPECT_NO_THROW(ServoLoop(p, *scene.algorithm, device, scene.windows, scene.tool));
  }
  LoopParameters p = simulated(20);
  p.record_ticks = 0;
  ServoLoop unrecorded(p, *scene.algorithm, device, scene.windows, scene.tool);
  const LoopResult run = unrecorded.runSimulated();
  EXPECT_EQ(run.ticks_run, 20);
  EXPECT_TRUE(run.records.empty());
}

// The monotonic clock of the standard library is the system's.
TEST(ServoClock, IsTheSystemsMonotonicOne) {
  const auto standard_ns = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  const std::int64_t before_ns = standard_ns();
  const std::int64_t now_ns = monotonicNow_ns();
  EXPECT_LE(before_ns, now_ns);
  EXPECT_LE(now_ns, standard_ns());
}

// No bound on any time here: the machine may be busy. What must hold is that grid points are run or counted as skipped.
TEST(ServoLoopReal, RunsTheAskedTicksOnTheGrid) {
  TouchScene scene(0.3);
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(300);
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  scene.publish(TouchScene::above(0), monotonicNow_ns());
  const std::int64_t before_ns = monotonicNow_ns();
  loop.start();
  const LoopResult run = loop.wait();
  EXPECT_FALSE(loop.running());
  EXPECT_GE(monotonicNow_ns() - before_ns, 299'000'000);
  EXPECT_EQ(run.ticks_run + run.ticks_skipped, 300);
  ASSERT_EQ(run.records.size(), static_cast<std::size_t>(run.ticks_run));
  EXPECT_TRUE(run.real_time.asked);
  EXPECT_EQ(run.real_time.notes.empty(), run.real_time.fifo && run.real_time.memory_locked);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const TickRecord& r = run.records[i];
    ASSERT_TRUE(i == 0 || r.tick > run.records[i - 1].tick);
    // A gap only after a missed deadline.
    if (i > 0 && r.tick != run.records[i - 1].tick + 1) {
      ASSERT_TRUE(has(run.records[i - 1].faults, ServoFault::kOverrun));
    }
    ASSERT_DOUBLE_EQ(r.time_s, static_cast<double>(r.tick) / 1000);
    ASSERT_GE(r.lateness_ns, 0);
    ASSERT_GT(r.tick_cost_ns, 0);
    // The simulated device keeps to the grid too, gaps or not.
    const Vec3 hip_W(r.hip_W[0], r.hip_W[1], r.hip_W[2]);
    ASSERT_LT((hip_W - scene.path.position(r.time_s)).norm(), 1e-12);
  }
  const RunFigures s = computeFigures(run.records, 1000);
  EXPECT_LE(s.tick_cost_us.p50, s.tick_cost_us.p90);
  EXPECT_LE(s.tick_cost_us.p90, s.tick_cost_us.p99);
  EXPECT_LE(s.tick_cost_us.p99, s.tick_cost_us.p999);
  EXPECT_LE(s.tick_cost_us.p999, s.tick_cost_us.max);
  EXPECT_GT(s.contact_ticks, 0);
}

// A device that takes 5 ms in one tick: flagged there, the grid points in between are left out, none is made up for.
class SlowOnce final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "slow once"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {8, 0}; }
  void elapse(int ticks) noexcept override { elapsed += ticks; }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    position_W = TouchScene::above(1e-3);
    if (++reads == 20) {
      const std::int64_t until_ns = monotonicNow_ns() + 5'000'000;
      while (monotonicNow_ns() < until_ns) {
      }
    }
    return true;
  }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return true; }
  std::atomic<int> reads = 0;
  int elapsed = 0;
};

// In a child that is nobody and may have no priority.
TEST(ServoLoopReal, WithoutPriorityItRefusesToStartWhereThatIsRequired) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a fork has no thread sanitizer";
#endif
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none = {0, 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    if (geteuid() == 0 && setuid(65534) != 0) _exit(3);
    TouchScene scene;
    SimulatedDevice device({}, scene.path, 1000);
    LoopParameters p = simulated(20);
    p.require_real_time = true;
    ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
    const auto refuses = [](const auto& work) {
      try {
        work();
      } catch (const Error& error) {
        return error.code() == Error::Code::kDevice &&
               std::string(error.what()).find("SCHED_FIFO 80") != std::string::npos;
      }
      return false;
    };
    if (refuses([&] { loop.start(); }) && refuses([] { checkRealTime(80); }) && !loop.running() &&
        loop.wait().ticks_run == 0)
      _exit(0);
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(ServoLoopReal, WhatIsAllowedIsNoReasonToRefuse) {
  TouchScene scene;
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(20);
  const bool allowed = [&] {
    ServoLoop asks(p, *scene.algorithm, device, scene.windows, scene.tool);
    asks.start();
    const LoopResult run = asks.wait();
    return run.real_time.granted();
  }();
  if (!allowed) GTEST_SKIP() << "this system gives no real-time priority or locks no memory";
  p.require_real_time = true;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  EXPECT_NO_THROW(checkRealTime(p.priority));
  EXPECT_NO_THROW(loop.start());
  EXPECT_GT(loop.wait().ticks_run, 0);
}

TEST(ServoLoopReal, AMissedDeadlineIsFlaggedAndTheGridKept) {
  TouchScene scene;
  SlowOnce device;
  LoopParameters p = simulated(0);
  p.record_ticks = 100'000;
  p.real_time = false;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  loop.start();
  while (device.reads < 60) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  loop.requestStop();
  const LoopResult run = loop.wait();
  EXPECT_FALSE(run.real_time.asked);
  ASSERT_EQ(run.records.front().tick, 0);  // all are there
  EXPECT_GE(run.ticks_skipped, 4);
  const TickRecord& slow = run.records[18];  // the first read was the constructor's
  EXPECT_TRUE(has(slow.faults, ServoFault::kOverrun));
  EXPECT_GE(slow.tick_cost_ns, 5'000'000);
  EXPECT_GE(run.records[19].tick - slow.tick, 5);
  EXPECT_EQ(device.elapsed, run.records.back().tick);
}

TEST(ServoLoopReal, StopsWhenAsked) {
  TouchScene scene;
  SimulatedDevice device({}, scene.path, 1000);
  LoopParameters p = simulated(0);
  p.record_ticks = 100;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  loop.start();
  while (scene.tool.latest().tick < 5) sleepUntil(monotonicNow_ns() + 1'000'000);
  loop.requestStop();
  EXPECT_GE(loop.wait().ticks_run, 6);
}

TEST(ServoLoopReal, RunsAtTwentyKilohertz) {
  TouchScene scene(0.1);
  SimulatedDevice device({}, scene.path, 20000);
  ServoLoop loop(simulated(2000, 20000), *scene.algorithm, device, scene.windows, scene.tool);
  scene.publish(TouchScene::above(0), monotonicNow_ns());
  loop.start();
  const LoopResult run = loop.wait();
  EXPECT_EQ(run.ticks_run + run.ticks_skipped, 2000);
}

}  // namespace servo_loop_test
}  // namespace palpate
