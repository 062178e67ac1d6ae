// SPDX-License-Identifier: Apache-2.0
// The way to another isovalue step by step, with looks that a test makes up.
#include "apps/rig/isovalue_way.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace isovalue_way_test {

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
      way.work({.wanted = wanted, .in_use = kFirst, .window_seen = window()}, kNow);
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
  IsovalueWay way{engine};
};

TEST_F(Way, GoesByGatheringShowingAndTaking) {
  const IsovalueWay::Look rest{.wanted = kFirst, .in_use = kFirst};
  way.work(rest, kNow);  // there is nowhere to go
  EXPECT_EQ(engine.isovalue(), kFirst);
  const std::uint64_t before = window();
  EXPECT_GT(gather(kNext), 2);
  EXPECT_EQ(engine.isovalue(), kNext);
  EXPECT_EQ(window(), before + 1);  // one window, with all of them
  EXPECT_FALSE(way.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = before}));
  EXPECT_FALSE(way.mayGive({.wanted = kOther, .in_use = kFirst, .window_seen = before + 1}));
  EXPECT_TRUE(way.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = before + 1}));
  EXPECT_FALSE(way.mayGive({.wanted = kNext, .in_use = kNext, .window_seen = before + 1}));  // it has been given
  const auto both = engine.planFacts().gradient_bricks;
  way.work({.wanted = kNext, .in_use = kNext, .taken = false}, kNow);
  EXPECT_EQ(engine.planFacts().gradient_bricks, both);
  way.work({.wanted = kNext, .in_use = kNext, .taken = true}, kNow);
  EXPECT_LT(engine.planFacts().gradient_bricks, both);
  expectAsNew(kNext);
}

TEST_F(Way, GathersAllAtOnceIfAsked) {
  way.work({.wanted = kNext, .in_use = kFirst, .all_at_once = true}, kNow);
  EXPECT_EQ(engine.isovalue(), kNext);
}

// Somebody wants another one, or the first again, at every stage.
TEST_F(Way, TurnsBackWhereverItIs) {
  for (const double instead : {kFirst, kOther}) {
    const IsovalueWay::Look other{.wanted = instead, .in_use = kFirst, .window_seen = 1000};
    way.work({.wanted = kNext, .in_use = kFirst}, kNow);  // gathering
    ASSERT_EQ(engine.isovalue(), kFirst);
    way.work(other, kNow);
    expectAsNew(kFirst);
    gather(kNext);  // shown
    ASSERT_EQ(engine.isovalue(), kNext);
    EXPECT_FALSE(way.mayGive(other));
    way.work(other, kNow);
    expectAsNew(kFirst);
  }
  gather(kOther);  // and it may begin anew
  way.end(kOther);
  expectAsNew(kOther);
}

// While the servo goes over, a newer wish has to wait.
TEST_F(Way, WaitsForTheServoBeforeItBeginsAnew) {
  gather(kNext);
  ASSERT_TRUE(way.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = window()}));
  for (int i = 0; i < 5; ++i) way.work({.wanted = kOther, .in_use = kNext, .taken = false}, kNow);
  EXPECT_EQ(engine.isovalue(), kNext);
  way.work({.wanted = kOther, .in_use = kNext, .taken = true}, kNow);  // ends the last
  expectAsNew(kNext);
  way.work({.wanted = kOther, .in_use = kNext, .all_at_once = true}, kNow);
  EXPECT_EQ(engine.isovalue(), kOther);
}

TEST_F(Way, EndsWhereverItIs) {
  way.end(kFirst);
  way.work({.wanted = kNext, .in_use = kFirst}, kNow);
  way.end(kFirst);
  expectAsNew(kFirst);
  gather(kNext);
  way.end(kFirst);
  expectAsNew(kFirst);
  gather(kNext);
  ASSERT_TRUE(way.mayGive({.wanted = kNext, .in_use = kFirst, .window_seen = window()}));
  way.end(kNext);
  expectAsNew(kNext);
}

TEST_F(Way, BeginsAnewAfterARefusal) {
  const double none = volume.maximum() + 1;
  EXPECT_THROW(way.work({.wanted = none, .in_use = kFirst}, kNow), Error);
  EXPECT_THROW(way.work({.wanted = none, .in_use = kFirst}, kNow), Error);
  gather(kNext);
  EXPECT_EQ(engine.isovalue(), kNext);
}

}  // namespace isovalue_way_test
}  // namespace palpate
