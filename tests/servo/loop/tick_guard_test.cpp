// SPDX-License-Identifier: Apache-2.0
// Between its first and its last tick the servo thread takes nothing from the heap, gives nothing back to it, and takes
// no lock.
#include <algorithm>
#include <cmath>
#include <mutex>

#include <gtest/gtest.h>

#include "servo/loop/servo_loop.hpp"
#include "support/fault_injection.hpp"
#include "support/tick_watch.hpp"
#include "support/touch_scene.hpp"
#include "support/troubled.hpp"
#include "wall_trials.hpp"

namespace palpate {
namespace tick_guard_test {

constexpr int kTicks = 300;

enum class Misdeed { kNone, kAllocate, kFree, kLock };

// A simulated device, read for the first time in the loop's first tick and written to for the last time in its last:
// the watch is over everything between. It can be told to do what it may not in the middle.
class WatchingDevice final : public Device {
 public:
  WatchingDevice(const Path& path, bool troubled, Misdeed misdeed) : inner_(path, troubled), misdeed_(misdeed) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "watching"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return inner_.limits(); }
  void elapse(int ticks) noexcept override { inner_.elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    if (++reads_ == 2) TickWatch::begin();  // the first is the constructor's
    if (reads_ == kTicks / 2) misbehave();
    return inner_.read(position_W);
  }
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override { return inner_.reportAge_ns(); }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    if (reads_ == kTicks + 1) TickWatch::end();
    return inner_.write(force_W);
  }

 private:
  void misbehave() noexcept {
    if (misdeed_ == Misdeed::kAllocate) taken_ = std::make_unique<int>(reads_);
    if (misdeed_ == Misdeed::kFree) spare_.reset();
    if (misdeed_ == Misdeed::kLock) const std::lock_guard lock(mutex_);
  }

  TroubledDevice inner_;
  Misdeed misdeed_;
  std::unique_ptr<int> taken_, spare_ = std::make_unique<int>(0);
  std::mutex mutex_;
  int reads_ = 0;
};

struct Watched {
  TickWatch::Seen seen;
  std::uint32_t faults = 0;  // raised in any tick
};

std::uint32_t faultsOf(const LoopResult& run) {
  std::uint32_t faults = 0;
  for (const TickRecord& r : run.records) faults |= r.faults;
  return faults;
}

// Ticks without end, so that missed deadlines do not shorten the watch; stopped once it is over.
Watched watch(std::string_view algorithm, Misdeed misdeed = Misdeed::kNone, bool troubled = false,
              bool changing = false) {
  TouchScene scene(0.2, algorithm);
  WatchingDevice device(scene.path, troubled, misdeed);
  TroubledAlgorithm troubled_algorithm(*scene.algorithm, troubled);
  LoopParameters p = troubled ? troubledParameters() : LoopParameters{};
  p.ticks = 0;
  p.record_ticks = 10 * kTicks;
  ServoChanges changes;
  LiveTicks live(256);
  ServoLoop loop(p, troubled_algorithm, device, scene.windows, scene.tool);
  if (changing) loop.takeChangesFrom(changes);
  if (changing) loop.tellTicksTo(live);
  loop.start();
  std::int64_t ticks = 0;
  for (std::int64_t seen = -1, looks = 0; ticks < 2 * kTicks; ++looks) {
    const ToolPose pose = scene.tool.latest();
    const bool new_pose = pose.tick != seen;
    seen = pose.tick;
    if (new_pose && ++ticks % 32 == 1) scene.publish(pose.position_W, monotonicNow_ns());
    if (changing && new_pose && ticks % 40 == 0)
      changes.give({.algorithm = makeFor(algorithm, {}, scene.volume, 4e-3),
                    .force_limit_N = static_cast<double>(1 + ticks % 7)});
    confirmWithTrouble(scene.windows, looks, troubled);
    sleepUntil(monotonicNow_ns() + 300'000);
  }
  loop.requestStop();
  const LoopResult run = loop.wait();
  EXPECT_GT(run.ticks_run, kTicks);
  return {TickWatch::seen(), faultsOf(run)};
}

TEST(TickGuard, TheServoThreadTakesNothing) {
  for (const AlgorithmEntry& entry : algorithms()) {
    EXPECT_EQ(watch(entry.name).seen.all(), 0) << entry.name;
  }
}

// What is replaced meanwhile is freed by who gives the next change.
TEST(TickGuard, TheServoThreadTakesNothingForAChange) {
  for (const char* name : {"hri", "blezek", "implicit", "hri-paper"})
    EXPECT_EQ(watch(name, Misdeed::kNone, false, true).seen.all(), 0) << name;
}

// Adaptive windowing, the passivity controller, and a gate that has always something to do. Which of the faults that
// come from the engine's side it meets depends on how busy the machine is; those of device and algorithm come by
// themselves.
TEST(TickGuard, TheServoThreadTakesNothingInTrouble) {
  const Watched watched = watch("hri", Misdeed::kNone, true);
  EXPECT_EQ(watched.seen.all(), 0);
  const std::uint32_t certain = bit(ServoFault::kNonFiniteForce) | bit(ServoFault::kDeviceError) |
                                bit(ServoFault::kStall) | bit(ServoFault::kDroppedReports);
  EXPECT_EQ(watched.faults & certain, certain) << faultNames(watched.faults);
}

// The same on the scripted clock, where every fault comes for certain. The script's own notes have their memory before.
TEST(TickGuard, TheLoopTakesNothingInAnyFault) {
  constexpr int kKinds = static_cast<int>(Injected::kCount);
  constexpr int kEach = 60;
  constexpr int kAll = kEach * (kKinds + 1);
  FaultScript script;
  for (int i = 0; i < kKinds; ++i) script.faults.push_back({static_cast<Injected>(i), kEach * (i + 1), 30, 1.0});
  ScriptedClock clock(script);
  const AnalyticVolume volume = millimetreVolume(ball(Vec3::Constant(8e-3), 5e-3), 16);
  ScriptedEngine engine(script, volume, Vec3::Constant(8e-3));
  const auto motion = [](int tick) { return Vec3(8e-3, 8e-3, 8e-3 + 1e-4 * std::sin(0.2 * tick)); };
  ScriptedDevice device(script, clock, motion, 1000);
  device.reserve(kAll + 1000);
  SteadyPush push(Vec3(0, 0, 2));
  ScriptedAlgorithm algorithm(script, push);
  WindowStorage storage(ScriptedEngine::kSide * ScriptedEngine::kSide * ScriptedEngine::kSide);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p = troubledParameters();
  p.ticks = 0;
  p.record_ticks = kAll;
  ServoLoop loop(p, algorithm, device, windows, tool);
  clock.before_tick = [&] {
    if (script.tick >= 5 && script.tick < kAll) engine.beforeTick(windows, clock.time_ns);
    if (script.tick == kAll - 1) loop.requestStop();
  };
  TickWatch::begin();
  const LoopResult run = loop.runOn(clock);
  TickWatch::end();
  EXPECT_EQ(TickWatch::seen().all(), 0);
  ASSERT_EQ(run.records.size(), static_cast<std::size_t>(kAll));
  // This push does not look where the tool is, so it is never beyond the window and loses no surface. Nor does the tool
  // follow it.
  constexpr std::uint32_t kOfASurface = bit(ServoFault::kBeyondWindow) | bit(ServoFault::kSurfaceLost) |
                                        bit(ServoFault::kPlaneBehind) | bit(ServoFault::kUnstable);
  const std::uint32_t raised = (kFadingFaults & ~kOfASurface) | bit(ServoFault::kForceLimited) |
                               bit(ServoFault::kSlewLimited) | bit(ServoFault::kOverrun);
  EXPECT_EQ(faultsOf(run) & raised, raised) << faultNames(faultsOf(run));
  EXPECT_TRUE(std::any_of(run.records.begin(), run.records.end(), [](const TickRecord& r) { return r.damped; }));
}

// A wall far too stiff for the device: swings, the guard's decision, the fade, a bounce, and the force that comes back.
TEST(TickGuard, TheLoopTakesNothingWhenItEndsAnUnstableContact) {
  const WantedPath path([](double t_s) { return Vec3(0, 0, std::fmod(t_s, 3.0) < 1.5 ? -1e-3 : 5e-3); });
  SimulatedDeviceParameters held;
  held.hand = Hand::kSpring;
  SimulatedDevice device(held, path, 1000);
  GroundAlgorithm wall({}, 15000, 2);
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 6000;
  ServoLoop loop(p, wall, device, windows, tool);
  TickWatch::begin();
  const LoopResult run = loop.runSimulated();
  TickWatch::end();
  EXPECT_EQ(TickWatch::seen().all(), 0);
  EXPECT_EQ(assessContact(run.records, {}).ended_by_servo, 1);
  EXPECT_GT(run.records[4400].force_W[2], 0.1);
}

TEST(TickGuard, WhatADeviceMayNotDoIsSeen) {
  const TickWatch::Seen allocation = watch("hri", Misdeed::kAllocate).seen;
  EXPECT_EQ(allocation.allocations, 1);
  EXPECT_EQ(allocation.all(), 1);
  const TickWatch::Seen given_back = watch("hri", Misdeed::kFree).seen;
  EXPECT_EQ(given_back.frees, 1);
  EXPECT_EQ(given_back.all(), 1);
  if (!TickWatch::seesLocks()) GTEST_SKIP() << "a sanitizer stands before the locks";
  const TickWatch::Seen lock = watch("hri", Misdeed::kLock).seen;
  EXPECT_EQ(lock.locks, 1);
  EXPECT_EQ(lock.all(), 1);
}

}  // namespace tick_guard_test
}  // namespace palpate
