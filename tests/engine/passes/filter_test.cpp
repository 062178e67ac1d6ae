// SPDX-License-Identifier: Apache-2.0
// The filter kernels against their twins, bit for bit.
#include "engine/reference/filter.hpp"

#include <bit>

#include <gtest/gtest.h>

#include "filter_on_gpu.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace {

struct Case {
  const char* chain;
  Vec3i size;
};
class FilterBits : public testing::TestWithParam<Case> {};

TEST_P(FilterBits, EqualTheTwin) {
  const auto steps = lowerFilters(filterChain(GetParam().chain), testLattice().spacing_m);
  const Volume fields[] = {ballField(GetParam().size, 9.0), extremes(GetParam().size)};
  for (const Volume& volume : fields) {
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps)),
              0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Gaussian, FilterBits,
                         testing::Values(Case{"gaussian:1.5", {41, 33, 37}},
                                         Case{"gaussian:1.5:border=mirror", {41, 33, 37}},
                                         Case{"gaussian:1mm", {40, 48, 24}}, Case{"gaussian:5", {60, 70, 50}},
                                         Case{"gaussian:10", {70, 9, 8}}, Case{"gaussian:2:border=mirror", {3, 2, 17}},
                                         Case{"gaussian:3:truncate=5", {2, 2, 2}},
                                         Case{"gaussian:0.6 gaussian:0.9", {30, 29, 28}}));

// The text of the kernel, compiled for the CPU, adds taps up as the twin does.
TEST(FilterText, ConvolvesAsTheTwin) {
  const Volume volume = extremes({40, 3, 2});
  const reference::DenseField field = reference::denseField(volume);
  const FilterStep step = lowerFilters(filterChain("gaussian:1.5"), Vec3::Ones())[0];
  const reference::DenseField after = reference::applyStep(field, step);
  for (int i = 5; i + 5 < 40; ++i) {
    float sum = step.taps[5] * field.at(i - 5, 1, 1);
    for (int tap = -4; tap <= 5; ++tap)
      sum = kernel_text::addTap(sum, step.taps[static_cast<std::size_t>(std::abs(tap))], field.at(i + tap, 1, 1));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(sum), std::bit_cast<std::uint32_t>(after.at(i, 1, 1))) << i;
  }
}

// Far from the ball nothing is stored, and nothing near it is lost.
TEST(FilterChain, KeepsASparseVolumeSparse) {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  const Volume volume = ballField({128, 128, 128}, 9.0);
  const BrickPool pool(gpu, transfer, volume);
  FilterChain chain(gpu, transfer, pool, lowerFilters(filterChain("gaussian:1.5"), Vec3::Ones()));
  chain.run();
  const Vec3i grown = Vec3i::Constant(2 * 9 + 2 * 3 + 2 * 5 + 16) / 8;  // ball, ramp, reach, and a brick's rounding
  EXPECT_LE(chain.result().storedBricks(), static_cast<std::size_t>(grown.prod()));
  EXPECT_GT(chain.result().storedBricks(), pool.storedBricks());
}

}  // namespace
}  // namespace palpate
