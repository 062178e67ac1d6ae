// SPDX-License-Identifier: Apache-2.0
// The servo thread takes nothing from the heap between its first and its last tick.
#include <gtest/gtest.h>

#include "heap_watch.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/touch_scene.hpp"

namespace palpate {
namespace {

constexpr int kTicks = 300;

// A simulated device, read for the first time in the loop's first tick and written to for the last time in its last:
// the watch is over everything between. It can be told to take memory in the middle.
class WatchingDevice final : public Device {
 public:
  WatchingDevice(const Path& path, bool allocates) : inner_({}, path, 1000), allocates_(allocates) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "watching"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return inner_.limits(); }
  void elapse(int ticks) noexcept override { inner_.elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    if (++reads_ == 2) HeapWatch::begin();  // the first is the constructor's
    if (allocates_ && reads_ == kTicks / 2) taken_ = std::make_unique<int>(reads_);
    return inner_.read(position_W);
  }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    if (reads_ == kTicks + 1) HeapWatch::end();
    return inner_.write(force_W);
  }

 private:
  SimulatedDevice inner_;
  bool allocates_;
  std::unique_ptr<int> taken_;
  int reads_ = 0;
};

// Ticks without end, so that missed deadlines do not shorten the watch; stopped once it is over.
long allocationsOfARun(std::string_view algorithm, bool device_allocates) {
  TouchScene scene(0.2, algorithm);
  WatchingDevice device(scene.path, device_allocates);
  LoopParameters p;
  p.ticks = 0;
  p.record_ticks = 10 * kTicks;
  ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
  loop.start();
  std::int64_t ticks = 0;
  for (std::int64_t seen = -1; ticks < 2 * kTicks;) {
    const ToolPose pose = scene.tool.latest();
    const bool new_pose = pose.tick != seen;
    seen = pose.tick;
    if (new_pose && ++ticks % 32 == 1) scene.publish(pose.position_W, monotonicNow_ns());
    scene.windows.confirm(monotonicNow_ns());
    sleepUntil(monotonicNow_ns() + 300'000);
  }
  loop.requestStop();
  const LoopResult run = loop.wait();
  EXPECT_GT(run.ticks_run, kTicks);
  return HeapWatch::count();
}

TEST(HeapGuard, TheServoThreadTakesNothing) {
  for (const AlgorithmEntry& entry : algorithms()) {
    EXPECT_EQ(allocationsOfARun(entry.name, false), 0) << entry.name;
  }
}

TEST(HeapGuard, ADeliberateAllocationIsSeen) {
  EXPECT_EQ(allocationsOfARun("hri", true), 1);
}

}  // namespace
}  // namespace palpate
