// SPDX-License-Identifier: Apache-2.0
// Whole fields that take several submissions: nothing is left out or computed twice, whatever the tuning.
#include "engine/filter_passes/filter_whole.hpp"

#include "filtered_fields.hpp"
#include "tests/engine/passes/tunings_by_name.hpp"

namespace palpate {
namespace filter_whole_test {

class FilterInParts : public testing::TestWithParam<Tuning> {};

// 14 x 11 x 10 bricks: one submission and a half of the row for CPUs. Steps along each axis, of one kernel and of two.
TEST_P(FilterInParts, EqualsTheTwin) {
  const Volume volume = makeField({107, 88, 80}, [](int i, int j, int k) {
    return static_cast<float>((i * 7919 + j * 104729 + k * 1299709) % 1000);
  });
  for (const char* chain : {"gaussian:0.7", "diffuse:1:kappa=300"}) {
    const auto steps = lowerFilters(filterChain(chain), volume.lattice().spacing_m);
    const reference::DenseField wanted = reference::applyFilters(reference::denseField(volume), steps);
    EXPECT_EQ(differing(filteredOnGpu(volume, steps, deviceOf(GetParam())), wanted), 0U) << chain;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, FilterInParts, testing::ValuesIn(tunings().begin(), tunings().end()),
                         [](const auto& row) { return deviceOf(row.param); });

}  // namespace filter_whole_test
}  // namespace palpate
