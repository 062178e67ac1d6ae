// SPDX-License-Identifier: Apache-2.0
#include "base/portion_size.hpp"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace portion_size_test {

// Bricks of a microsecond to a fifth of a second, all alike: from the fifth portion on each takes between half and
// once the target, or is as large or as small as it can be. None before that is longer than 64 bricks or the target.
TEST(PortionSize, GoesForItsTargetWhateverABrickTakes) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const double brick_s = std::pow(10, -6 + 5.3 * static_cast<double>(random()) / 4294967296.0);
    const auto most = static_cast<std::uint32_t>(1 + random() % 20000);
    PortionSize size(most);
    EXPECT_EQ(size.bricks(), std::min(PortionSize::kFirst, most));
    for (int n = 0; n < 12; ++n) {
      const double seconds = brick_s * size.bricks();
      ASSERT_TRUE(n == 0 || seconds <= PortionSize::kTarget_s * (1 + 1e-9) || size.bricks() == 1) << brick_s;
      const bool free = size.bricks() > 1 && size.bricks() < most;
      ASSERT_TRUE(n < 6 || !free || seconds >= PortionSize::kTarget_s / 2) << brick_s;
      size.took(size.bricks(), seconds);
      ASSERT_GE(size.bricks(), 1U);
      ASSERT_LE(size.bricks(), most);
    }
  }
}

// Where bricks become slower the next submission is smaller at once; a clock that does not move makes it grow.
TEST(PortionSize, FollowsWhatBricksTake) {
  PortionSize size(1000);
  size.took(64, 0);
  EXPECT_EQ(size.bricks(), 256U);
  size.took(256, 25.6);
  EXPECT_EQ(size.bricks(), 1U);
  size.took(1, 0.01);
  EXPECT_EQ(size.bricks(), 4U);
}

}  // namespace portion_size_test
}  // namespace palpate
