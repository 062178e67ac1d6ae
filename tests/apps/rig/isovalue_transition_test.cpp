// SPDX-License-Identifier: Apache-2.0
// The transition to another isovalue step by step, with looks that the test makes up.
#include "apps/rig/isovalue_transition.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace isovalue_transition_test {

constexpr double kFirst = 150, kNext = 50, kOther = 100;
constexpr std::int64_t kNow = 1;

// Density falls from the middle by 4 a voxel, so the isosurfaces share few bricks, and those of another are made in
// several portions.
Volume hill() {
  const Vec3i size = Vec3i::Constant(96);
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i)
        values.push_back(static_cast<float>(200 - 4 * (Vec3(i, j, k) - Vec3(47.3, 46.8, 48.1)).norm()));
    }
  }
  return Volume::fromDense(size, {}, values, {});
}

class Way : public testing::Test {
 protected:
  Way() : volume(hill()), engine(volume, makePlan({}), kFirst, "") {
    engine.publishAround(volume.lattice().toWorld(Vec3(47, 47, 47)), kNow);
  }
  [[nodiscard]] std::uint64_t window() { return engine.exchange().nextVersion() - 1; }
  // Steps until the samples are all there; how many steps that took.
  int gather(double wanted) {
    int steps = 0;
    do {
      transition.work({.wanted = wanted, .in_use = kFirst, .window_seen = window()}, kNow);
      ++steps;
    } while (engine.isovalue() == kFirst && steps < 1000);
    return steps;
  }
  // As an engine that was started so.
  void expectAsNew(double isovalue) {
    Engine fresh(volume, makePlan({}), isovalue, "");
    EXPECT_EQ(engine.isovalue(), isovalue);
    EXPECT_EQ(engine.planFacts().gradient_bricks, fresh.planFacts().gradient_bricks);
  }

  Volume volume;
  Engine engine;
  IsovalueTransition transition{engine};
};

TEST_F(Way, GoesByGatheringShowingAndTaking) {
  const IsovalueTransition::Look rest{.wanted = kFirst, .in_use = kFirst};
  transition.work(rest, kNow);  // there is nowhere to go
  EXPECT_EQ(engine.isovalue(), kFirst);
  const std::uint64_t before = window();
  EXPECT_GT(gather(kNext), 2);
  EXPECT_EQ(engine.isovalue(), kNext);
  EXPECT_EQ(window(), before + 1);  // one window, with all of them
  EXPECT_FALSE(transition.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = before}));
  EXPECT_FALSE(transition.mayGive({.wanted = kOther, .in_use = kFirst, .window_seen = before + 1}));
  EXPECT_TRUE(transition.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = before + 1}));
  EXPECT_FALSE(transition.mayGive({.wanted = kNext, .in_use = kNext, .window_seen = before + 1}));  // it has been given
  const auto both = engine.planFacts().gradient_bricks;
  transition.work({.wanted = kNext, .in_use = kNext, .taken = false}, kNow);
  EXPECT_EQ(engine.planFacts().gradient_bricks, both);
  transition.work({.wanted = kNext, .in_use = kNext, .taken = true}, kNow);
  EXPECT_LT(engine.planFacts().gradient_bricks, both);
  expectAsNew(kNext);
}

TEST_F(Way, GathersAllAtOnceIfAsked) {
  transition.work({.wanted = kNext, .in_use = kFirst, .all_at_once = true}, kNow);
  EXPECT_EQ(engine.isovalue(), kNext);
}

// Somebody wants another one, or the first again, at every stage.
TEST_F(Way, TurnsBackWhereverItIs) {
  for (const double instead : {kFirst, kOther}) {
    const IsovalueTransition::Look other{.wanted = instead, .in_use = kFirst, .window_seen = 1000};
    transition.work({.wanted = kNext, .in_use = kFirst}, kNow);  // gathering
    ASSERT_EQ(engine.isovalue(), kFirst);
    transition.work(other, kNow);
    expectAsNew(kFirst);
    gather(kNext);  // shown
    ASSERT_EQ(engine.isovalue(), kNext);
    EXPECT_FALSE(transition.mayGive(other));
    transition.work(other, kNow);
    expectAsNew(kFirst);
  }
  gather(kOther);  // and it may begin anew
  transition.end(kOther);
  expectAsNew(kOther);
}

// While the servo goes over, a newer wish has to wait.
TEST_F(Way, WaitsForTheServoBeforeItBeginsAnew) {
  gather(kNext);
  ASSERT_TRUE(transition.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = window()}));
  for (int i = 0; i < 5; ++i) transition.work({.wanted = kOther, .in_use = kNext, .taken = false}, kNow);
  EXPECT_EQ(engine.isovalue(), kNext);
  transition.work({.wanted = kOther, .in_use = kNext, .taken = true}, kNow);  // ends the last
  expectAsNew(kNext);
  transition.work({.wanted = kOther, .in_use = kNext, .all_at_once = true}, kNow);
  EXPECT_EQ(engine.isovalue(), kOther);
}

TEST_F(Way, EndsWhereverItIs) {
  transition.end(kFirst);
  transition.work({.wanted = kNext, .in_use = kFirst}, kNow);
  transition.end(kFirst);
  expectAsNew(kFirst);
  gather(kNext);
  transition.end(kFirst);
  expectAsNew(kFirst);
  gather(kNext);
  ASSERT_TRUE(transition.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = window()}));
  transition.end(kNext);
  expectAsNew(kNext);
}

TEST_F(Way, BeginsAnewAfterARefusal) {
  const double none = volume.maximum() + 1;
  EXPECT_THROW(transition.work({.wanted = none, .in_use = kFirst}, kNow), Error);
  EXPECT_THROW(transition.work({.wanted = none, .in_use = kFirst}, kNow), Error);
  gather(kNext);
  EXPECT_EQ(engine.isovalue(), kNext);
}

}  // namespace isovalue_transition_test
}  // namespace palpate
