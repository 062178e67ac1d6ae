// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/velocity.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace velocity_test {

TEST(VelocityEstimate, EachNameIsMadeAndMeasuresARamp) {
  for (const VelocityEntry& entry : velocityEstimates()) {
    // No low-pass: both are then exact on a straight ramp.
    VelocityEstimate velocity({.name = std::string(entry.name), .cutoff_hz = 0, .noise_m = 1e-6}, 1000);
    velocity.reset(Vec3::Zero());
    EXPECT_TRUE(velocity.value().isZero(0));
    for (int k = 1; k <= 20; ++k) velocity.update(Vec3(0, 1e-3 * k, 0), 1);
    EXPECT_NEAR(velocity.value().y(), 1, 1e-12) << entry.name;
    EXPECT_NE(entry.description, "");
  }
  EXPECT_EQ(velocityEstimates().front().name, VelocityParameters{}.name);
}

TEST(VelocityEstimate, TheNameChooses) {
  VelocityEstimate filter({.name = "filter"}, 1000), foaw({.name = "foaw", .noise_m = 1e-6}, 1000);
  filter.reset(Vec3::Zero());
  foaw.reset(Vec3::Zero());
  filter.update(Vec3(1e-3, 0, 0), 1);
  foaw.update(Vec3(1e-3, 0, 0), 1);
  EXPECT_LT(filter.value().x(), 0.9);  // 200 Hz: 1 - e^(-0.4 pi) = 0.72 of it after a tick
  EXPECT_NEAR(foaw.value().x(), 1, 1e-12);
}

// A position that is finite, but so far off that the difference is not: a jump, not a velocity, and no harm is left.
TEST(VelocityEstimate, IsFiniteAfterAJumpThatIsNot) {
  for (const char* name : {"filter", "foaw"}) {
    VelocityEstimate velocity({.name = name, .noise_m = 1e-6}, 1000);
    velocity.reset(Vec3::Zero());
    velocity.update(Vec3(std::numeric_limits<double>::max(), 0, 0), 1);
    EXPECT_TRUE(velocity.value().allFinite()) << name;
    velocity.update(Vec3::Zero(), 1);
    EXPECT_TRUE(velocity.value().allFinite()) << name;
    for (int k = 1; k <= 100; ++k) velocity.update(Vec3(1e-3 * k, 0, 0), 1);
    EXPECT_NEAR(velocity.value().x(), 1, 1e-12) << name;
  }
}

// Where nobody says how noisy positions are, a step after a rest is all motion: no longer window fits it.
TEST(VelocityEstimate, WithoutANoiseBoundThereIsNoNoise) {
  for (const int window_ticks : {1, 32}) {
    VelocityEstimate velocity({.name = "foaw", .window_ticks = window_ticks}, 1000);
    velocity.reset(Vec3::Zero());
    for (int k = 0; k < 3; ++k) velocity.update(Vec3::Zero(), 1);
    velocity.update(Vec3(1e-6, 0, 0), 1);
    EXPECT_NEAR(velocity.value().x(), 1e-3, 1e-15) << window_ticks;
  }
}

TEST(VelocityEstimate, RefusesWhatIsNotKnownOrNoNumber) {
  const auto refusal = [](const VelocityParameters& p) -> std::string {
    try {
      VelocityEstimate velocity(p, 1000);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({.name = "kalman"}), testing::HasSubstr("filter, foaw"));
  EXPECT_THAT(refusal({.cutoff_hz = std::numeric_limits<double>::infinity()}), testing::HasSubstr("cutoff"));
  EXPECT_THAT(refusal({.noise_m = -1e-6}), testing::HasSubstr("noise"));
  EXPECT_THAT(refusal({.noise_m = std::numeric_limits<double>::quiet_NaN()}), testing::HasSubstr("noise"));
  EXPECT_THAT(refusal({.window_ticks = 0}), testing::HasSubstr("window"));
  EXPECT_THAT(refusal({.window_ticks = 33}), testing::HasSubstr("window"));
}

}  // namespace velocity_test
}  // namespace palpate
