// SPDX-License-Identifier: Apache-2.0
// The engine's thread follows the tool and keeps confirming. No times are asserted: the test waits for what must come.
#include "engine/service/engine_thread.hpp"

#include <atomic>
#include <chrono>
#include <stdexcept>

#include <gtest/gtest.h>

#include "engine/phantoms/phantom.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace engine_thread_test {

template <typename Condition>
bool comes(Condition condition) {
  for (int i = 0; i < 20000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

void putTool(ToolPoseMailbox& poses, const Vec3& p_W, std::int64_t tick) {
  poses.back() = {p_W, Vec3::Zero(), tick, 0};
  poses.publish();
}

TEST(EngineThread, FollowsTheTool) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=64"));
  Engine engine(volume, makePlan({}), 0, "");
  ToolPoseMailbox poses;
  EngineThread thread(engine, poses);
  WindowExchange& windows = engine.exchange();
  putTool(poses, volume.lattice().toWorld({16, 16, 16}), 0);
  ASSERT_TRUE(comes([&] { return windows.latest().version == 1; }));
  putTool(poses, volume.lattice().toWorld({48, 48, 48}), 1);
  ASSERT_TRUE(comes([&] { return windows.latest().version == 2; }));
  EXPECT_EQ(thread.publications(), 2U);

  const std::int64_t confirmed_ns = windows.confirmedAt_ns();
  EXPECT_TRUE(comes([&] { return windows.confirmedAt_ns() > confirmed_ns; }));
  thread.stop();
  const std::int64_t last_ns = windows.confirmedAt_ns();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(windows.confirmedAt_ns(), last_ns);  // a stopped engine vouches for nothing
}

// A servo whose thread takes long to begin finds the first window fresh, however long the driver's compiler took for it.
TEST(EngineThread, ConfirmsTheFirstWindowBeforeTheFirstTick) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=32"));
  Engine engine(volume, makePlan({}), 0, "");
  ToolPoseMailbox poses;
  {
    EngineThread nothing(engine, poses);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(engine.exchange().confirmedAt_ns(), 0);  // there is no window to confirm
    nothing.stop();
  }
  ASSERT_TRUE(engine.publishAround(volume.lattice().toWorld({16, 16, 16}), 5));
  EXPECT_EQ(engine.exchange().confirmedAt_ns(), 5);
  EngineThread thread(engine, poses);
  EXPECT_TRUE(comes([&] { return engine.exchange().confirmedAt_ns() > 5; }));
  EXPECT_EQ(thread.publications(), 0U);
  EXPECT_EQ(engine.exchange().latest().version, 1U);
}

// What follows the tool sees every pose that the engine acts on, and works on where no tick ever comes. Its failure is
// the thread's.
TEST(EngineThread, CallsWhoFollows) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=32"));
  Engine engine(volume, makePlan({}), 0, "");
  ToolPoseMailbox poses;
  std::atomic<std::int64_t> seen = -2;
  std::atomic<bool> failed = false;
  const auto follow = [&](const ToolPose& pose, std::int64_t) {
    seen = pose.tick;
    if (pose.tick == 7) throw std::runtime_error("enough");
    return false;
  };
  EngineThread thread(engine, poses, follow, [&] { failed = true; });
  ASSERT_TRUE(comes([&] { return seen == -1; }));
  putTool(poses, volume.lattice().toWorld({16, 16, 16}), 3);
  ASSERT_TRUE(comes([&] { return seen == 3; }));
  EXPECT_FALSE(failed);
  putTool(poses, volume.lattice().toWorld({16, 16, 16}), 7);
  ASSERT_TRUE(comes([&] { return failed.load(); }));  // at once, so that a run need not go on to its end
  EXPECT_EQ(seen, 7);
  EXPECT_THROW(thread.stop(), std::runtime_error);
}

TEST(EngineThread, WaitsForTheFirstTick) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=32"));
  Engine engine(volume, makePlan({}), 0, "");
  ToolPoseMailbox poses;
  EngineThread thread(engine, poses);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  thread.stop();
  EXPECT_EQ(thread.publications(), 0U);
}

}  // namespace engine_thread_test
}  // namespace palpate
