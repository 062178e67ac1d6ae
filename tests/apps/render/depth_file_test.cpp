// SPDX-License-Identifier: Apache-2.0
// The bytes of the format, by hand.
#include "apps/render/depth_file.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace depth_file_test {

TEST(DepthFile, HoldsTheRowsFromTheBottomAsLittleEndianFloats) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const RenderedImage image{2, 3, std::vector<std::uint8_t>(24), {1, kInfinity, 0.5F, 2, -1.5F, 3}};
  const std::string rows(
      "\x00\x00\xC0\xBF\x00\x00\x40\x40"   // -1.5 and 3
      "\x00\x00\x00\x3F\x00\x00\x00\x40"   // 0.5 and 2
      "\x00\x00\x80\x3F\x00\x00\x80\x7F",  // 1 and infinity
      24);
  EXPECT_EQ(pfmOf(image), "Pf\n2 3\n-1.0\n" + rows);
}

}  // namespace depth_file_test
}  // namespace palpate
