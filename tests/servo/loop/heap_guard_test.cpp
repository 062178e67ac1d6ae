// SPDX-License-Identifier: Apache-2.0
// The servo thread takes nothing from the heap between its first and its last tick.
#include <gtest/gtest.h>

#include "heap_watch.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/touch_scene.hpp"
#include "support/troubled.hpp"

namespace palpate {
namespace {

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
  bool damped = false;       // by the passivity controller, in any tick
};

// Ticks without end, so that missed deadlines do not shorten the watch; stopped once it is over.
Watched watch(std::string_view algorithm, bool device_allocates, bool troubled = false) {
  TouchScene scene(0.2, algorithm);
  WatchingDevice device(scene.path, troubled, device_allocates);
  TroubledAlgorithm troubled_algorithm(*scene.algorithm, troubled);
  LoopParameters p = troubled ? troubledParameters() : LoopParameters{};
  p.ticks = 0;
  p.record_ticks = 10 * kTicks;
  ServoLoop loop(p, troubled_algorithm, device, scene.windows, scene.tool);
  loop.start();
  std::int64_t ticks = 0;
  for (std::int64_t seen = -1, looks = 0; ticks < 2 * kTicks; ++looks) {
    const ToolPose pose = scene.tool.latest();
    const bool new_pose = pose.tick != seen;
    seen = pose.tick;
    if (new_pose && ++ticks % 32 == 1) scene.publish(pose.position_W, monotonicNow_ns());
    confirmWithTrouble(scene.windows, looks, troubled);
    sleepUntil(monotonicNow_ns() + 300'000);
  }
  loop.requestStop();
  const LoopResult run = loop.wait();
  EXPECT_GT(run.ticks_run, kTicks);
  Watched watched;
  watched.allocations = HeapWatch::count();
  for (const TickRecord& r : run.records) {
    watched.faults |= r.faults;
    watched.damped = watched.damped || r.damped;
  }
  return watched;
}

TEST(HeapGuard, TheServoThreadTakesNothing) {
  EXPECT_EQ(watch("hri", false).allocations, 0);
  EXPECT_EQ(watch("hri-paper", false).allocations, 0);
}

// With every fault that the gate knows, adaptive windowing and the passivity controller.
TEST(HeapGuard, TheServoThreadTakesNothingInTrouble) {
  const Watched watched = watch("hri", false, true);
  EXPECT_EQ(watched.allocations, 0);
  const std::uint32_t raised = kFadingFaults & ~bit(ServoFault::kNoWindow) & ~bit(ServoFault::kBeyondWindow);
  EXPECT_EQ(watched.faults & raised, raised) << faultNames(watched.faults);
  EXPECT_TRUE(has(watched.faults, ServoFault::kForceLimited) && has(watched.faults, ServoFault::kSlewLimited));
  EXPECT_TRUE(watched.damped);
}

TEST(HeapGuard, ADeliberateAllocationIsSeen) {
  EXPECT_EQ(watch("hri", true).allocations, 1);
}

}  // namespace
}  // namespace palpate
