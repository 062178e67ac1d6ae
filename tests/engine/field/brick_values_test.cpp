// SPDX-License-Identifier: Apache-2.0
#include "engine/field/brick_values.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "tests/engine/files/files.hpp"

namespace palpate {
namespace brick_values_test {

using Brick = std::array<float, kBrickVoxels>;

TEST(BrickValues, OneValueIsOneOfBits) {
  for (const float value : {0.0F, -0.0F, 1e-40F, std::nanf("")}) {
    Brick brick;
    brick.fill(value);
    EXPECT_TRUE(holdOneValue(brick));
    for (const std::size_t at : {0, 1, 511}) {
      brick[at] = value == 0 ? -value : 3;  // the other zero is another value
      EXPECT_FALSE(holdOneValue(brick)) << value << " " << at;
      brick[at] = value;
    }
  }
  EXPECT_FALSE(sameBits(0.0F, -0.0F));
  EXPECT_TRUE(sameBits(-0.0F, -0.0F));
}

// Equal values of other bits differ; a NaN, which equals nothing, has its own bits.
TEST(BrickValues, BricksAreComparedByBits) {
  Brick a{};
  a[511] = std::nanf("");
  Brick b = a;
  EXPECT_TRUE(sameBits(a, b));
  b[510] = -0.0F;
  EXPECT_FALSE(sameBits(a, b));
}

TEST(BrickValues, PutsOneOr512AndNothingElse) {
  Volume volume = Volume::fromDense({16, 8, 8}, plainLattice(), std::vector<float>(1024, 1.0F), {});
  Brick brick;
  for (std::size_t n = 0; n < brick.size(); ++n) brick[n] = static_cast<float>(n);
  putBrick(volume, {1, 0, 0}, brick);
  Brick read;
  EXPECT_FALSE(volume.readBrick({1, 0, 0}, read.data()));
  EXPECT_EQ(read, brick);
  putBrick(volume, {0, 0, 0}, std::span(brick).subspan(7, 1));
  EXPECT_TRUE(volume.readBrick({0, 0, 0}, read.data()));
  EXPECT_EQ(read[0], 7);
  const std::vector<float> before = volume.toDense();
  for (const std::size_t count : {0, 2, 511}) {
    EXPECT_THROW(putBrick(volume, {0, 0, 0}, std::span(brick).first(count)), std::length_error);
  }
  EXPECT_EQ(volume.toDense(), before);
  try {
    putBrick(volume, {1, 2, 3}, std::span(brick).first(5));
    ADD_FAILURE();
  } catch (const std::length_error& error) {
    EXPECT_STREQ(error.what(), "brick (1, 2, 3) has 5 densities");
  }
}

}  // namespace brick_values_test
}  // namespace palpate
