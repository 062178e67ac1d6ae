// SPDX-License-Identifier: Apache-2.0
#include "apps/view/picture_png.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "decoded.hpp"

namespace palpate {
namespace picture_png_test {

const RenderedImage kImage{
    2, 3, {10, 20, 30, 0, 40, 50, 60, 255, 70, 80, 90, 7, 1, 2, 3, 0, 255, 255, 255, 0, 0, 0, 0, 9}, {}};

TEST(PicturePng, HoldsEveryPixelWhateverItsAlpha) {
  const Decoded decoded = decode(pngOf(kImage));
  ASSERT_EQ(decoded.width, 2);
  ASSERT_EQ(decoded.height, 3);
  EXPECT_EQ(decoded.at(0, 0), 0x0A141EU);
  EXPECT_EQ(decoded.at(1, 0), 0x28323CU);
  EXPECT_EQ(decoded.at(0, 1), 0x46505AU);
  EXPECT_EQ(decoded.at(1, 1), 0x010203U);
  EXPECT_EQ(decoded.at(0, 2), 0xFFFFFFU);
  EXPECT_EQ(decoded.at(1, 2), 0x000000U);
}

TEST(PicturePng, CanBeCancelled) {
  EXPECT_THROW((void)pngOf(kImage, [] { throw std::runtime_error("stop"); }), std::runtime_error);
}

}  // namespace picture_png_test
}  // namespace palpate
