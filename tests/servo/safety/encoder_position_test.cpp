// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/encoder_position.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace encoder_position_test {

Vec3 rounded(const Vec3& x, double step) {
  return Vec3((x.array() / step).round() * step);
}

TEST(EncoderPosition, WithoutResolutionIsTheReading) {
  EncoderPosition position(0);
  position.reset(Vec3(1, 2, 3));
  position.read(Vec3(-1, 0, 5), 1);
  EXPECT_EQ(position.value(), Vec3(-1, 0, 5));
}

// A step of 1 after a rest: the edge at half a step has just been crossed. One every fourth tick: an eighth of a step
// beyond the edge. A step or more a tick: the middle.
TEST(EncoderPosition, LiesBetweenEdgeAndMiddleByTheSpeed) {
  EncoderPosition position(1);
  position.reset(Vec3::Zero());
  position.read(Vec3(1, -1, 0), 1);
  EXPECT_NEAR(position.value().x(), 0.5, 1e-5);
  EXPECT_NEAR(position.value().y(), -0.5, 1e-5);
  EXPECT_EQ(position.value().z(), 0);
  position.read(Vec3(2, -2, 0), 4);
  EXPECT_DOUBLE_EQ(position.value().x(), 1.5 + 0.125);
  EXPECT_DOUBLE_EQ(position.value().y(), -1.5 - 0.125);
  position.read(Vec3(2, -3, 0), 1);  // x stays
  EXPECT_DOUBLE_EQ(position.value().x(), 1.5 + 0.125);
  EXPECT_DOUBLE_EQ(position.value().y(), -3);
  position.read(Vec3(7, -3, 0), 1);  // 5 steps in 2 ticks
  EXPECT_DOUBLE_EQ(position.value().x(), 7);
  position.reset(Vec3(7, 7, 7));
  EXPECT_EQ(position.value(), Vec3(7, 7, 7));
  position.read(Vec3(6, 7, 7), 1);  // at rest before
  EXPECT_NEAR(position.value().x(), 6.5, 1e-5);
}

// A walk of any speed: never farther from the truth than a step.
TEST(EncoderPosition, IsWithinAStepOfTheTruth) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int walk = 0; walk < 200; ++walk) {
    const double step = std::pow(10, 3 * unit(random));
    EncoderPosition position(step);
    Vec3 x = Vec3::Zero(), v = Vec3::Zero();
    position.reset(rounded(x, step));
    for (int tick = 0; tick < 500; ++tick) {
      v = 0.95 * v + 0.3 * Vec3(unit(random), unit(random), unit(random));
      x += v;
      position.read(rounded(x, step), 1);
      ASSERT_LE((position.value() - x).cwiseAbs().maxCoeff(), step * (1 + 1e-9)) << walk << ' ' << tick;
    }
  }
}

// A spring pressed in and out by a sine, its force made of the readings as a servo makes it and held over each tick:
// what it gave is known from the true way. The sum over the readings finds a leak that is not there; that over the
// positions here is on average off by less than a fifth of that, and never by more than a step times the force's
// changes.
TEST(EncoderPosition, MakesTheEnergyOfAPressTrue) {
  std::mt19937 random(5);
  const auto decades = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  double bare_sum = 0, sum = 0;  // shares of the energy stored
  for (int i = 0; i < 1000; ++i) {
    const double step_m = decades(1e-6, 50e-6), depth_m = decades(0.3e-3, 3e-3), ticks = decades(20, 3000);
    constexpr double kStiffness = 1000;
    EncoderPosition position(step_m);
    position.reset(Vec3::Zero());
    double true_J = 0, bare_J = 0, found_J = 0, changes_N = 0;
    double x = 0, reading = 0, held = 0, force_N = 0;
    for (int k = 1; k <= ticks + 2; ++k) {
      const double next = k < ticks ? depth_m * std::sin(M_PI * k / ticks) : 0;
      const double next_reading = std::round(next / step_m) * step_m;
      position.read(Vec3(next_reading, 0, 0), 1);
      true_J += force_N * (next - x);
      bare_J += force_N * (next_reading - reading);
      found_J += force_N * (position.value().x() - held);
      x = next;
      reading = next_reading;
      held = position.value().x();
      changes_N += std::abs(kStiffness * reading - force_N);
      force_N = kStiffness * reading;
    }
    ASSERT_LE(std::abs(found_J - true_J), step_m * changes_N * (1 + 1e-9)) << i;
    const double stored_J = kStiffness * depth_m * depth_m / 2;
    bare_sum += std::abs(bare_J - true_J) / stored_J;
    sum += std::abs(found_J - true_J) / stored_J;
  }
  EXPECT_LT(sum, bare_sum / 5);
}

}  // namespace encoder_position_test
}  // namespace palpate
