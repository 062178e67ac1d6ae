// SPDX-License-Identifier: Apache-2.0
// Changes from one thread to another: taken once, freed by who gives the next.
#include "servo/loop/servo_changes.hpp"

#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "changing_press.hpp"

namespace palpate {
namespace servo_changes_test {

// Counts how many of its kind live.
class Counted final : public Algorithm {
 public:
  explicit Counted(int& alive) : alive_(alive) { ++alive_; }
  ~Counted() override { --alive_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput&, TickOutput&) noexcept override {}

 private:
  int& alive_;
};

TEST(ServoChanges, AreTakenOnceAndFreedByTheNextGiver) {
  int alive = 0;
  {
    ServoChanges changes;
    EXPECT_EQ(changes.take(), nullptr);
    changes.give({.algorithm = std::make_unique<Counted>(alive)});
    ServoChange* taken = changes.take();
    ASSERT_NE(taken, nullptr);
    EXPECT_EQ(changes.take(), nullptr);
    changes.done(taken);
    EXPECT_EQ(alive, 1) << "the servo frees nothing";
    changes.give({.force_limit_N = 2.0});
    EXPECT_EQ(alive, 0);
    changes.give({.algorithm = std::make_unique<Counted>(alive)});
    changes.done(changes.take());
    EXPECT_EQ(alive, 1);
  }
  EXPECT_EQ(alive, 0);
}

TEST(ServoChanges, ThatWereNotTakenAreMadePartOfTheNext) {
  int alive = 0;
  ServoChanges changes;
  changes.give({.algorithm = std::make_unique<Counted>(alive), .force_limit_N = 3.0});
  changes.give({.force_limit_N = 2.0});
  changes.give({.algorithm = std::make_unique<Counted>(alive)});
  EXPECT_EQ(alive, 1) << "the first was replaced before anybody ran it";
  ServoChange* taken = changes.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_NE(taken->algorithm, nullptr);
  EXPECT_EQ(taken->force_limit_N, 2.0);
  changes.done(taken);
  EXPECT_EQ(changes.take(), nullptr);
}

TEST(ServoChanges, ThatWereTakenBackAreNotMade) {
  int alive = 0;
  ServoChanges changes;
  changes.withdraw();
  const std::uint64_t taken_back = changes.give({.algorithm = std::make_unique<Counted>(alive)});
  changes.withdraw();
  EXPECT_EQ(alive, 0);
  EXPECT_EQ(changes.take(), nullptr);
  EXPECT_FALSE(changes.ended(taken_back));
  changes.give({.force_limit_N = 2.0});
  ServoChange* const taken = changes.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(taken->algorithm, nullptr);
  changes.done(taken);
  EXPECT_TRUE(changes.ended(taken_back));
}

// Until then what was replaced may still run. One that was made part of the next ends with it.
TEST(ServoChanges, HaveEndedOnceTheServoIsDoneWithThemOrWithALaterOne) {
  ServoChanges changes;
  const std::uint64_t first = changes.give({.force_limit_N = 2.0});
  const std::uint64_t second = changes.give({.force_limit_N = 3.0});
  EXPECT_FALSE(changes.ended(first));
  ServoChange* taken = changes.take();
  EXPECT_FALSE(changes.ended(second));
  const std::uint64_t third = changes.give({.force_limit_N = 4.0});
  changes.done(taken);
  EXPECT_TRUE(changes.ended(first));
  EXPECT_TRUE(changes.ended(second));
  EXPECT_FALSE(changes.ended(third));
  changes.done(changes.take());
  EXPECT_TRUE(changes.ended(third));
}

// The servo can refuse nothing, so it is refused here.
TEST(ServoChanges, NoForceLimitThatIsNoneComesThrough) {
  ServoChanges changes;
  for (const double limit_N :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(changes.give({.force_limit_N = limit_N}), Error) << limit_N;
  EXPECT_EQ(changes.take(), nullptr);
}

// What the servo had in hand and what it took since: both come back though nobody collects in between.
TEST(ServoChanges, TwoMayWaitToBeFreed) {
  int alive = 0;
  ServoChanges changes;
  changes.give({.algorithm = std::make_unique<Counted>(alive)});
  ServoChange* first = changes.take();
  changes.give({.algorithm = std::make_unique<Counted>(alive)});
  changes.done(first);
  changes.done(changes.take());
  EXPECT_EQ(alive, 2);
  changes.give({});
  EXPECT_EQ(alive, 0);
}

// Both clocks take changes; here another thread gives them as fast as it can while the servo's runs.
TEST(ServoLoopChanges, AreTakenInRealTime) {
  Press press("hri", stiff(500), pressAndHold(1e-3));
  press.parameters.real_time = false;
  SimulatedDevice device(press.device_parameters, press.path, 1000);
  ServoLoop loop(press.parameters, *press.algorithm, device, press.scene.windows, press.scene.tool);
  LiveTicks live(64);
  loop.takeChangesFrom(press.changes);
  loop.tellTicksTo(live);
  press.scene.publish(onBall(0, 0), monotonicNow_ns());
  loop.start();
  int given = 0;
  std::int64_t seen = -1;
  while (loop.running()) {
    press.scene.windows.confirm(monotonicNow_ns());
    press.changes.give({.algorithm = press.make("hri", stiff(400 + given % 200)), .force_limit_N = 4 + given % 3});
    ++given;
    EXPECT_GE(live.latest().tick, seen);
    seen = live.latest().tick;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const LoopResult result = loop.wait();
  EXPECT_GT(given, 20);
  EXPECT_GT(seen, 0);
  const TickRecord& last = result.records.back();
  EXPECT_TRUE(last.in_contact);
  EXPECT_NEAR(force(last).norm(), 0.5, 0.11);  // 400 to 600 N/m
}

}  // namespace servo_changes_test
}  // namespace palpate
