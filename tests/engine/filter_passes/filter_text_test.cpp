// SPDX-License-Identifier: Apache-2.0
// The text of the filter kernels, compiled for the CPU, against the twins, which were written apart: bit for bit, but
// where exponentials enter (filter_edge_test.cpp holds that text to the library's, and the kernels to the text).
#include <gtest/gtest.h>

#include "engine/reference/filter.hpp"
#include "filters_by_text.hpp"
#include "tests/engine/passes/field_bits.hpp"
#include "tests/engine/passes/test_fields.hpp"

namespace palpate {
namespace filter_text_test {

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

}  // namespace filter_text_test
}  // namespace palpate
