// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/tuning.hpp"

#include <set>

#include <gtest/gtest.h>

#include "shaders/brick_pool.layout.h"

namespace palpate {
namespace tuning_test {

TEST(Tuning, IsFoundByKindOfDevice) {
  gpu::GpuInfo info;
  info.tuned_as = "cpu";
  EXPECT_EQ(tuningFor(info).device, "cpu");
  for (const char* other : {"discrete", "integrated", "virtual", "other", ""}) {
    info.tuned_as = other;
    EXPECT_EQ(tuningFor(info).device, "") << other;
  }
}

TEST(Tuning, HasARowAKindAndTheOneForAllOthersLast) {
  std::set<std::string_view> kinds;
  for (const Tuning& row : tunings()) EXPECT_TRUE(kinds.insert(row.device).second) << row.device;
  EXPECT_EQ(tunings().back().device, "");
}

TEST(Tuning, OfTheGradientDividesABrick) {
  for (const Tuning& row : tunings()) {
    for (const std::uint32_t run : {row.gradient_run, row.short_gradient_run}) {
      ASSERT_GE(run, 1U);
      EXPECT_EQ(BRICK_EDGE % run, 0U) << row.device;
    }
  }
}

TEST(Tuning, OfASubmissionFillsWorkGroups) {
  for (const Tuning& row : tunings()) {
    for (const std::uint32_t bricks : {row.filter_bricks, row.gradient_bricks}) {
      EXPECT_GT(bricks, 0U) << row.device;
      EXPECT_EQ(bricks % 8, 0U) << row.device;  // bricks of a work group at most
    }
  }
}

TEST(Tuning, OfADeviceIsWhatItIsUnlessAskedOtherwise) {
  EXPECT_EQ(gpu::Gpu({}).info().tuned_as, gpu::Gpu({}).info().type);
  EXPECT_EQ(gpu::Gpu({.tuned_as = "discrete"}).info().tuned_as, "discrete");
}

}  // namespace tuning_test
}  // namespace palpate
