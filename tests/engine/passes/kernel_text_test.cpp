// SPDX-License-Identifier: Apache-2.0
// The text of the gradient kernels, compiled for the CPU, against the twins, which were written apart: bit for bit.
// And the border's rule, which all kernels share. That of edits: tests/engine/edit/edit_math_test.cpp.
#include <algorithm>
#include <array>
#include <bit>

#include <gtest/gtest.h>

#include "by_text.hpp"
#include "engine/reference/gradient.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace kernel_text_test {

using reference::DenseField;

TEST(GradientText, DiffersInNoBitFromTheTwin) {
  for (const char* name : {"central", "central4", "sobel"}) {
    const GradientOperator gradient_operator = gradientOperator(name);
    for (const Vec3i& size : {Vec3i(19, 10, 9), Vec3i(3, 4, 5), Vec3i(2, 1, 9)}) {
      for (const Volume& volume : {ballField(size, 4.0), extremes(size), largest(size)}) {
        const DenseField field = reference::denseField(volume);
        std::size_t wrong = 0;
        by_text::forEachVoxel(field, [&](const Vec3i& voxel, std::size_t) {
          const auto text = by_text::gradientAt(field, gradient_operator, voxel);
          const auto twin = reference::gradientAt(field, gradient_operator, voxel.x(), voxel.y(), voxel.z());
          using Words = std::array<std::uint32_t, 3>;
          wrong += std::bit_cast<Words>(text) != std::bit_cast<Words>(twin) ? 1U : 0U;
        });
        EXPECT_EQ(wrong, 0U) << name << " on " << size.transpose();
      }
    }
  }
}

// The border's rule, by walking: a mirror at a voxel's outer face shows the voxels in turn, there and back.
TEST(BorderText, WalksThereAndBack) {
  for (const int size : {1, 2, 3, 7}) {
    int inside = 0;
    int way = 1;
    for (int c = 0; c < 5 * size; ++c) {
      EXPECT_EQ(kernel_text::insideOf(c, size, BORDER_MIRROR), inside) << c << " of " << size;
      EXPECT_EQ(kernel_text::insideOf(-1 - c, size, BORDER_MIRROR), inside) << c << " of " << size;
      EXPECT_EQ(kernel_text::insideOf(c, size, BORDER_NEAREST), std::min(c, size - 1));
      EXPECT_EQ(kernel_text::insideOf(-1 - c, size, BORDER_NEAREST), 0);
      const bool turns = inside + way < 0 || inside + way >= size;
      if (turns) way = -way;
      if (!turns) inside += way;
    }
  }
}

}  // namespace kernel_text_test
}  // namespace palpate
