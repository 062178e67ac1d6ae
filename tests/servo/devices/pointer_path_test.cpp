// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pointer_path.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace pointer_path_test {

constexpr double kTau_s = PointerPath::kTimeConstant_s;

// A path, and the pointer's end.
struct Led {
  explicit Led(const Vec3& start_W) : path(start_W) { path.follow(aims); }
  PointerAimBlock aims;
  PointerAim pointer{aims};
  PointerPath path;
};

TEST(PointerPath, RestsUntilItIsAimed) {
  const Led led(Vec3(1, 2, 3));
  const PointerPath& path = led.path;
  EXPECT_EQ(path.position(0), Vec3(1, 2, 3));
  EXPECT_EQ(path.position(5), Vec3(1, 2, 3));
  EXPECT_TRUE(std::isinf(path.duration_s()));
}

// From rest, a critically damped spring is at 1 - (1 + t / tau) exp(-t / tau) of its way, however it was stepped.
TEST(PointerPath, FollowsAsACriticallyDampedSpringAtAnyRate) {
  for (const double rate_hz : {250.0, 1000.0, 20000.0}) {
    Led led(Vec3::Zero());
    const PointerPath& path = led.path;
    led.pointer.aim(Vec3(1e-3, 0, -2e-3));  // so near that the limit of speed is not met
    for (int tick = 1; tick <= rate_hz * 0.2; ++tick) {
      const double t = tick / rate_hz;
      const double share = 1 - (1 + t / kTau_s) * std::exp(-t / kTau_s);
      ASSERT_NEAR((path.position(t) - share * Vec3(1e-3, 0, -2e-3)).norm(), 0, 1e-12) << rate_hz << ' ' << t;
    }
  }
}

// A metre away: never faster than the limit, no overshoot to speak of, and it arrives. When the speed is cut, the
// spring goes on with that speed, so it may pass the aim by some of v tau.
TEST(PointerPath, IsNoFasterThanAHand) {
  Led led(Vec3::Zero());
  const PointerPath& path = led.path;
  led.pointer.aim(Vec3(0.5, 0, 0));
  Vec3 last = Vec3::Zero();
  double farthest = 0;
  for (int tick = 1; tick <= 3000; ++tick) {
    const Vec3 now = path.position(tick * 1e-3);
    ASSERT_LE((now - last).norm(), PointerPath::kFastest_m_per_s * 1e-3 * (1 + 1e-9)) << tick;
    farthest = std::max(farthest, now.x());
    last = now;
  }
  EXPECT_NEAR(last.x(), 0.5, 1e-6);
  EXPECT_LE(farthest, 0.5 + 1e-9);
}

// Aims that jump about at sixty a second: from tick to tick the speed changes by no more than the spring can pull.
TEST(PointerPath, HasNoStepInItsSpeed) {
  Led led(Vec3::Zero());
  const PointerPath& path = led.path;
  Vec3 last = Vec3::Zero(), speed = Vec3::Zero();
  for (int tick = 1; tick <= 2000; ++tick) {
    if (tick % 16 == 0) led.pointer.aim(Vec3(2e-3 * std::sin(tick), 2e-3 * std::cos(7.0 * tick), 0));
    const Vec3 now = path.position(tick * 1e-3);
    const Vec3 next_speed = (now - last) / 1e-3;
    // x'' = -(x - aim) / tau^2 - 2 x' / tau, with at most 4 mm to go and the speed that this allows.
    const double most = 4e-3 / (kTau_s * kTau_s) + 2 * speed.norm() / kTau_s;
    ASSERT_LE((next_speed - speed).norm() / 1e-3, 1.2 * most + 1e-6) << tick;
    last = now;
    speed = next_speed;
  }
}

// The device asks for the start of a tick again, which is the end of the last one.
TEST(PointerPath, StandsStillInTime) {
  Led led(Vec3::Zero());
  const PointerPath& path = led.path;
  led.pointer.aim(Vec3::UnitX() * 1e-3);
  const Vec3 there = path.position(0.01);
  led.pointer.aim(Vec3::UnitY());
  EXPECT_EQ(path.position(0.01), there);
  EXPECT_EQ(path.position(0.005), there);
}

// Another process may write anything: what is no place in the world is not followed, and the next place is.
TEST(PointerPath, IsLedNowhereByWhatIsNoPlace) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e300, 1e7}) {
    Led led(Vec3(1, 2, 3));
    led.pointer.aim(Vec3(1, 2, bad));
    EXPECT_EQ(led.path.position(1), Vec3(1, 2, 3)) << bad;
    led.pointer.aim(Vec3(1, 2, 3.001));
    EXPECT_NEAR(led.path.position(2).z(), 3.001, 1e-9) << bad;
  }
}

// Until the first aim it goes the other way, and from there on without a step, in place or in speed.
TEST(PointerPath, GoesAnotherWayUntilItIsAimed) {
  const SampledPath way({0, 1}, {Vec3(0, 0, 0), Vec3(0.05, 0, 0)}, SampledPath::Interpolation::kLinear);
  PointerPath path(way);
  PointerAimBlock aims;
  PointerAim pointer(aims);
  path.follow(aims);
  for (int tick = 1; tick <= 500; ++tick) ASSERT_EQ(path.position(tick * 1e-3), way.position(tick * 1e-3));
  pointer.aim(Vec3(std::nan(""), 0, 0));
  EXPECT_EQ(path.position(0.501), way.position(0.501));
  pointer.aim(Vec3(0.0252, 0, 0));
  Vec3 last = path.position(0.502), speed(0.05, 0, 0);
  for (int tick = 503; tick < 700; ++tick) {
    const Vec3 now = path.position(tick * 1e-3), next_speed = (now - last) / 1e-3;
    ASSERT_LE((next_speed - speed).norm() / 1e-3, 1.2 * (2e-3 / (kTau_s * kTau_s) + 2 * speed.norm() / kTau_s)) << tick;
    last = now;
    speed = next_speed;
  }
  EXPECT_NEAR(last.x(), 0.0252, 1e-5);
}

// The aims of one engine after another: those of the block before count no more, and the place stays until the first.
TEST(PointerPath, FollowsOneBlockAfterAnother) {
  Led led(Vec3::Zero());
  EXPECT_FALSE(led.path.hasFollowed());
  led.pointer.aim(Vec3(1e-3, 0, 0));
  EXPECT_NEAR(led.path.position(1).x(), 1e-3, 1e-9);
  EXPECT_TRUE(led.path.hasFollowed());
  PointerAimBlock others;
  PointerAim other(others);
  led.path.follow(others);
  EXPECT_FALSE(led.path.hasFollowed());
  led.pointer.aim(Vec3(5e-3, 0, 0));
  EXPECT_NEAR(led.path.position(2).x(), 1e-3, 1e-9);
  EXPECT_TRUE(led.path.hasFollowed());
  other.aim(Vec3(-1e-3, 0, 0));
  EXPECT_NEAR(led.path.position(3).x(), -1e-3, 1e-9);
}

// At once, from whatever speed, and at rest; then as from any place.
TEST(PointerPath, LeapsWhereItIsPut) {
  Led led(Vec3::Zero());
  const PointerPath& path = led.path;
  led.pointer.aim(Vec3(0.5, 0, 0));
  for (int tick = 1; tick <= 100; ++tick) static_cast<void>(path.position(tick * 1e-3));
  EXPECT_EQ(path.leaps(), 0U);
  led.pointer.aim(PointerTarget(Vec3(0, 1e-3, 2), Vec3(0, 0, 2)));
  EXPECT_EQ(path.position(0.101), Vec3(0, 0, 2));
  EXPECT_EQ(path.leaps(), 1U);
  const double t_s = 0.03, share = 1 - (1 + t_s / kTau_s) * std::exp(-t_s / kTau_s);
  EXPECT_NEAR((path.position(0.101 + t_s) - Vec3(0, share * 1e-3, 2)).norm(), 0, 1e-12);
  EXPECT_EQ(path.leaps(), 1U);
}

// Aims came after it before the path looked.
// Each aim tells of the last leap; the tool is put there only once.
TEST(PointerPath, MakesALeapOnce) {
  Led led(Vec3::Zero());
  const PointerPath& path = led.path;
  led.pointer.aim(PointerTarget(Vec3(0.1, 0, 0), Vec3(0.09, 0, 0)));
  EXPECT_EQ(path.position(1e-3), Vec3(0.09, 0, 0));
  Vec3 last_W = path.position(2e-3);
  for (int tick = 3; tick < 200; ++tick) {
    led.pointer.aim(Vec3(0.1 + 1e-5 * tick, 0, 0));
    const Vec3 now_W = path.position(tick * 1e-3);
    ASSERT_GE(now_W.x(), last_W.x()) << tick;
    last_W = now_W;
  }
  EXPECT_EQ(path.leaps(), 1U);
}

TEST(PointerPath, OverlooksNoLeap) {
  Led led(Vec3::Zero());
  led.pointer.aim(PointerTarget(Vec3(1, 0, 0), Vec3(2, 0, 0)));
  led.pointer.aim(Vec3(3, 0, 0));
  EXPECT_EQ(led.path.position(1e-3), Vec3(2, 0, 0));
  EXPECT_EQ(led.path.leaps(), 1U);
  EXPECT_NEAR(led.path.position(5).x(), 3, 1e-9);
  // What is no place is not followed, and a leap from there is none.
  led.pointer.aim(PointerTarget(Vec3(4, 0, 0), Vec3(std::nan(""), 0, 0)));
  EXPECT_NEAR(led.path.position(6).x(), 3, 1e-9);
  EXPECT_EQ(led.path.leaps(), 1U);
}

// Without a pointer's end it stays where it is.
TEST(PointerPath, RestsWithoutAPointer) {
  const PointerPath path(Vec3(1, 2, 3));
  EXPECT_EQ(path.position(7), Vec3(1, 2, 3));
}

}  // namespace pointer_path_test
}  // namespace palpate
