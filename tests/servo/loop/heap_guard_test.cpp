// SPDX-License-Identifier: Apache-2.0
// The servo thread takes nothing from the heap between its first and its last tick.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "heap_watch.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/fault_injection.hpp"
#include "support/touch_scene.hpp"
#include "support/troubled.hpp"

namespace palpate {
namespace heap_guard_test {

constexpr int kTicks = 300;

// A simulated device, read for the first time in the loop's first tick and written to for the last time in its last:
// the watch is over everything between. It can be told to take memory in the middle.
class WatchingDevice final : public Device {
 public:
  WatchingDevice(const Path& path, bool troubled, bool allocates) : inner_(path, troubled), allocates_(allocates) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "watching"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return inner_.limits(); }
  void elapse(int ticks) noexcept override { inner_.elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    if (++reads_ == 2) HeapWatch::begin();  // the first is the constructor's
    if (allocates_ && reads_ == kTicks / 2) taken_ = std::make_unique<int>(reads_);
    return inner_.read(position_W);
  }
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override { return inner_.reportAge_ns(); }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    if (reads_ == kTicks + 1) HeapWatch::end();
    return inner_.write(force_W);
  }

 private:
  TroubledDevice inner_;
  bool allocates_;
  std::unique_ptr<int> taken_;
  int reads_ = 0;
};

struct Watched {
  long allocations = 0;
  std::uint32_t faults = 0;  // raised in any tick
};

std::uint32_t faultsOf(const LoopResult& run) {
  std::uint32_t faults = 0;
  for (const TickRecord& r : run.records) faults |= r.faults;
  return faults;
}

// Ticks without end, so that missed deadlines do not shorten the watch; stopped once it is over.
Watched watch(std::string_view algorithm, bool device_allocates, bool troubled = false, bool changing = false) {
  TouchScene scene(0.2, algorithm);
  WatchingDevice device(scene.path, troubled, device_allocates);
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
  return {HeapWatch::count(), faultsOf(run)};
}

TEST(HeapGuard, TheServoThreadTakesNothing) {
  for (const AlgorithmEntry& entry : algorithms()) {
    EXPECT_EQ(watch(entry.name, false).allocations, 0) << entry.name;
  }
}

// What is replaced meanwhile is freed by who gives the next change.
TEST(HeapGuard, TheServoThreadTakesNothingForAChange) {
  for (const char* name : {"hri", "blezek", "implicit", "hri-paper"})
    EXPECT_EQ(watch(name, false, false, true).allocations, 0) << name;
}

// Adaptive windowing, the passivity controller, and a gate that has always something to do. Which of the faults that
// come from the engine's side it meets depends on how busy the machine is; those of device and algorithm come by
// themselves.
TEST(HeapGuard, TheServoThreadTakesNothingInTrouble) {
  const Watched watched = watch("hri", false, true);
  EXPECT_EQ(watched.allocations, 0);
  const std::uint32_t certain = bit(ServoFault::kNonFiniteForce) | bit(ServoFault::kDeviceError) |
                                bit(ServoFault::kStall) | bit(ServoFault::kDroppedReports);
  EXPECT_EQ(watched.faults & certain, certain) << faultNames(watched.faults);
}

// The same on the scripted clock, where every fault comes for certain. The script's own notes have their memory before.
TEST(HeapGuard, TheLoopTakesNothingInAnyFault) {
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
  HeapWatch::begin();
  const LoopResult run = loop.runOn(clock);
  HeapWatch::end();
  EXPECT_EQ(HeapWatch::count(), 0);
  ASSERT_EQ(run.records.size(), static_cast<std::size_t>(kAll));
  // This push does not look where the tool is, so it is never beyond the window and loses no surface.
  constexpr std::uint32_t kOfASurface =
      bit(ServoFault::kBeyondWindow) | bit(ServoFault::kSurfaceLost) | bit(ServoFault::kPlaneBehind);
  const std::uint32_t raised = (kFadingFaults & ~kOfASurface) | bit(ServoFault::kForceLimited) |
                               bit(ServoFault::kSlewLimited) | bit(ServoFault::kOverrun);
  EXPECT_EQ(faultsOf(run) & raised, raised) << faultNames(faultsOf(run));
  EXPECT_TRUE(std::any_of(run.records.begin(), run.records.end(), [](const TickRecord& r) { return r.damped; }));
}

TEST(HeapGuard, ADeliberateAllocationIsSeen) {
  EXPECT_EQ(watch("hri", true).allocations, 1);
}

}  // namespace heap_guard_test
}  // namespace palpate
