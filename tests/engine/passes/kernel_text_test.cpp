// SPDX-License-Identifier: Apache-2.0
// The text of filters and gradients, compiled for the CPU, against the twins, which were written apart: bit for bit, but
// where exponentials enter (filter_edge_test.cpp holds that text to the library's, and the kernels to the text). That of
// edits: tests/engine/edit/edit_math_test.cpp.
#include <gtest/gtest.h>

#include "by_text.hpp"
#include "engine/reference/filter.hpp"
#include "engine/reference/gradient.hpp"
#include "field_bits.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace kernel_text_test {

using reference::DenseField;

struct Case {
  const char* chain;
  Vec3i size;
};
class FilterText : public testing::TestWithParam<Case> {};

TEST_P(FilterText, DiffersInNoBitFromTheTwin) {
  const auto steps = lowerFilters(filterChain(GetParam().chain), testLattice().spacing_m, 0.5F);
  for (const Volume& volume : {ballField(GetParam().size, 7.0), extremes(GetParam().size), largest(GetParam().size)}) {
    const DenseField field = reference::denseField(volume);
    EXPECT_EQ(differing(by_text::filtered(field, steps), reference::applyFilters(field, steps)), 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Filters, FilterText,
    testing::Values(Case{"gaussian:1.5", {21, 19, 17}}, Case{"gaussian:2:border=mirror", {3, 2, 17}},
                    Case{"diffuse:3:kappa=1", {21, 19, 17}}, Case{"diffuse:2:kappa=1e20", {2, 9, 1}},
                    Case{"median:1", {21, 19, 17}}, Case{"median:1:border=mirror", {9, 2, 3}},
                    Case{"median:2", {13, 12, 11}}, Case{"median:2:border=mirror", {3, 9, 2}},
                    Case{"median:3:border=mirror", {9, 8, 7}}, Case{"median:1mm", {9, 8, 7}},
                    Case{"dilate:2", {13, 12, 11}}, Case{"erode:2:shape=ball:border=mirror", {13, 12, 11}},
                    Case{"distance:4", {21, 19, 17}}, Case{"distance:6", {9, 17, 8}}, Case{"distance:2", {2, 9, 1}},
                    Case{"distance:3", {1, 2, 1}}));

TEST(GradientText, DiffersInNoBitFromTheTwin) {
  for (const char* name : {"central", "central4", "sobel"}) {
    const GradientOperator way = gradientOperator(name);
    for (const Vec3i& size : {Vec3i(19, 10, 9), Vec3i(3, 4, 5), Vec3i(2, 1, 9)}) {
      for (const Volume& volume : {ballField(size, 4.0), extremes(size), largest(size)}) {
        const DenseField field = reference::denseField(volume);
        std::size_t wrong = 0;
        by_text::forEachVoxel(field, [&](const Vec3i& voxel, std::size_t) {
          const auto text = by_text::gradientAt(field, way, voxel);
          const auto twin = reference::gradientAt(field, way, voxel.x(), voxel.y(), voxel.z());
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
