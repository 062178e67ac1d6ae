// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/foaw.hpp"

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace foaw_test {

constexpr double kRate_hz = 1000;
constexpr double kDelta_m = 1e-6;  // of the encoders
constexpr int kWindow = 16;

double rounded(double x_m) {
  return std::round(x_m / kDelta_m) * kDelta_m;
}

// Rounded positions err by Delta / 2 each, so a slope over k ticks errs by Delta / (k T) at most; the window holds all
// k ticks since the start of the ramp, up to 16, whatever the speed. Rounding adds 1e-12 of a position's size per tick.
TEST(Foaw, OnARampItErrsByTheResolutionOverTheWindow) {
  for (const double speed : {1e-5, 3.7e-4, -0.0123, 0.31, -1.7}) {
    Foaw foaw(kDelta_m, kWindow, kRate_hz);
    foaw.reset(Vec3(0, rounded(0.01), 0));
    for (int k = 1; k <= 200; ++k) {
      const Vec3 velocity_W = foaw.update(Vec3(0, rounded(0.01 + speed * k / kRate_hz), 0), 1);
      const double bound = kDelta_m * kRate_hz / std::min(k, kWindow);
      ASSERT_NEAR(velocity_W.y(), speed, bound + 1e-12 * kRate_hz) << "speed " << speed << " tick " << k;
      ASSERT_EQ(velocity_W.x(), 0);
    }
  }
}

// At rest for long, then off at ten Delta a tick: a window that reaches back to the rest would miss the corner by at
// least 5 Delta, so one tick is the window, at once.
TEST(Foaw, FollowsAStepInVelocityWithoutDelay) {
  Foaw foaw(kDelta_m, kWindow, kRate_hz);
  foaw.reset(Vec3::Zero());
  for (int k = 0; k < 40; ++k) EXPECT_TRUE(foaw.update(Vec3::Zero(), 1).isZero(0));
  const double speed = 10 * kDelta_m * kRate_hz;
  for (int k = 1; k <= 40; ++k) {
    const Vec3 velocity_W = foaw.update(Vec3(0, 0, speed * k / kRate_hz), 1);
    ASSERT_NEAR(velocity_W.z(), speed, kDelta_m * kRate_hz / std::min(k, kWindow)) << k;
  }
}

// A tenth of Delta a tick: the bare difference is Delta / T in one tick of ten, 0 in nine: a mean square error of
// 0.1 0.9 (Delta / T)^2. The window's error is at most Delta / (16 T).
TEST(Foaw, SlowMotionIsQuiet) {
  Foaw foaw(kDelta_m, kWindow, kRate_hz);
  foaw.reset(Vec3::Zero());
  const double speed = 0.1 * kDelta_m * kRate_hz;
  double last_m = 0, foaw_square = 0, bare_square = 0;
  constexpr int kTicks = 1000;
  for (int k = 1; k <= kTicks; ++k) {
    const double x_m = rounded(speed * k / kRate_hz);
    const double velocity = foaw.update(Vec3(x_m, 0, 0), 1).x();
    if (k > kWindow) foaw_square += (velocity - speed) * (velocity - speed);
    bare_square += std::pow((x_m - last_m) * kRate_hz - speed, 2);
    last_m = x_m;
  }
  const double unit = kDelta_m * kRate_hz * kDelta_m * kRate_hz;
  EXPECT_NEAR(bare_square / kTicks, 0.09 * unit, 0.01 * unit);
  EXPECT_LE(foaw_square / (kTicks - kWindow), unit / (kWindow * kWindow) * (1 + 1e-9));
}

TEST(Foaw, WithoutANoiseBoundItIsTheBackwardDifference) {
  Foaw foaw(0, kWindow, kRate_hz);
  foaw.reset(Vec3::Zero());
  EXPECT_NEAR(foaw.update(Vec3(1e-3, 0, 0), 1).x(), 1, 1e-12);
  EXPECT_NEAR(foaw.update(Vec3(3e-3, 0, 0), 1).x(), 2, 1e-12);
}

TEST(Foaw, MissedTicksCountAsTheirTime) {
  Foaw foaw(kDelta_m, kWindow, kRate_hz);
  foaw.reset(Vec3::Zero());
  int k = 0;
  for (const int ticks : {1, 1, 5, 2, 1, 3, 1}) {
    k += ticks;
    EXPECT_NEAR(foaw.update(Vec3(0.2e-3 * k, 0, 0), ticks).x(), 0.2, 1e-12) << k;
  }
  // A gap longer than the window: the difference over the gap, whatever lies before.
  EXPECT_NEAR(foaw.update(Vec3(0.2e-3 * k + 1e-2, 0, 0), 100).x(), 0.1, 1e-12);
}

// The paper's own test, every line against every position between.
double byTheBook(const std::vector<std::pair<int, double>>& past, double noise_m, int window) {
  const auto [now, now_m] = past.back();
  double best = 0;
  for (std::size_t n = 1; n < past.size(); ++n) {
    const auto [then, then_m] = past[past.size() - 1 - n];
    if (n > 1 && now - then > window) break;
    const double slope = (now_m - then_m) / (now - then);
    for (std::size_t i = 1; i < n; ++i) {
      const auto [between, x_m] = past[past.size() - 1 - i];
      if (std::abs(now_m - slope * (now - between) - x_m) > noise_m) return best * kRate_hz;
    }
    best = slope;
  }
  return best * kRate_hz;
}

// Random motion, smooth for a while and then turned, with random gaps: the same slope up to rounding. A window differs
// only where a test is a tie to the last bits, which random numbers do not give.
TEST(Foaw, IsThePapersWindow) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int window : {1, 7, 16, 32}) {
    Foaw foaw(kDelta_m, window, kRate_hz);
    std::vector<std::pair<int, double>> past = {{0, 0.0}};
    foaw.reset(Vec3::Zero());
    double speed = 0, x_m = 0;
    for (int i = 0; i < 2000; ++i) {
      if (uniform(random) > 0.9) speed = 2e-6 * uniform(random);  // [m/tick]
      const int ticks = uniform(random) > 0.8 ? 3 : 1;
      x_m += speed * ticks;
      past.emplace_back(past.back().first + ticks, x_m + 0.5 * kDelta_m * uniform(random));
      const double velocity = foaw.update(Vec3(0, 0, past.back().second), ticks).z();
      ASSERT_NEAR(velocity, byTheBook(past, kDelta_m, window), 1e-12) << i;
    }
  }
}

TEST(Foaw, ResetForgets) {
  Foaw foaw(kDelta_m, kWindow, kRate_hz);
  foaw.reset(Vec3::Zero());
  for (int k = 1; k < 50; ++k) static_cast<void>(foaw.update(Vec3(1e-3 * k, 0, 0), 1));
  foaw.reset(Vec3(1, 0, 0));
  EXPECT_TRUE(foaw.update(Vec3(1, 0, 0), 1).isZero(0));
}

}  // namespace foaw_test
}  // namespace palpate
