// SPDX-License-Identifier: Apache-2.0
// The filter kernels against their twins, bit for bit.
#include "engine/reference/filter.hpp"

#include <gtest/gtest.h>

#include "filtered_fields.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace filter_test {

struct Case {
  const char* chain;
  Vec3i size;
  Vec3i smaller = size;  // but in a long run, where the twin takes seconds
};
class FilterBits : public testing::TestWithParam<Case> {};

TEST_P(FilterBits, EqualTheTwin) {
  const auto steps = lowerFilters(filterChain(GetParam().chain), testLattice().spacing_m);
  const Vec3i size = isLongRun() ? GetParam().size : GetParam().smaller;
  const Volume fields[] = {ballField(size, 9.0), extremes(size)};
  for (const Volume& volume : fields) {
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps)),
              0U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Gaussian, FilterBits,
    testing::Values(Case{"gaussian:1.5", {41, 33, 37}}, Case{"gaussian:1.5:border=mirror", {41, 33, 37}},
                    Case{"gaussian:1mm", {40, 48, 24}}, Case{"gaussian:5", {60, 70, 50}},
                    Case{"gaussian:10", {70, 9, 8}}, Case{"gaussian:2:border=mirror", {3, 2, 17}},
                    Case{"gaussian:3:truncate=5", {2, 2, 2}}, Case{"gaussian:1:border=mirror", {1, 1, 1}},
                    Case{"gaussian:1:border=mirror", {1, 19, 17}}, Case{"gaussian:0.6 gaussian:0.9", {30, 29, 28}}));

// Flat windows, odd sizes, volumes thinner than the window, cut bricks.
INSTANTIATE_TEST_SUITE_P(Median, FilterBits,
                         testing::Values(Case{"median:1", {41, 33, 37}}, Case{"median:1:border=mirror", {17, 30, 25}},
                                         Case{"median:1", {40, 48, 24}}, Case{"median:0.8mm", {33, 26, 18}},
                                         Case{"median:1mm", {33, 26, 18}}, Case{"median:1", {2, 2, 2}},
                                         Case{"median:2", {9, 1, 17}}, Case{"close:2:shape=ball", {17, 9, 1}},
                                         Case{"open:2", {1, 9, 17}}, Case{"median:1", {2, 19, 30}},
                                         Case{"median:1", {30, 2, 19}}, Case{"median:1", {19, 30, 2}}));

INSTANTIATE_TEST_SUITE_P(WideMedian, FilterBits,
                         testing::Values(Case{"median:2", {33, 26, 27}}, Case{"median:2:border=mirror", {19, 26, 17}},
                                         Case{"median:3", {26, 33, 25}}, Case{"median:3:border=mirror", {9, 10, 11}},
                                         Case{"median:1.4mm", {33, 26, 18}},
                                         Case{"median:1.5mm:border=mirror", {11, 26, 25}},
                                         Case{"median:2.1mm", {19, 18, 17}},
                                         Case{"median:3:border=mirror", {2, 3, 2}}));

INSTANTIATE_TEST_SUITE_P(Box, FilterBits,
                         testing::Values(Case{"dilate:1", {41, 33, 37}}, Case{"erode:2", {41, 33, 37}},
                                         Case{"close:1", {41, 33, 37}}, Case{"open:1mm", {41, 33, 37}},
                                         Case{"dilate:3:border=mirror", {41, 33, 37}}, Case{"erode:4", {40, 41, 42}},
                                         Case{"dilate:7", {60, 41, 42}}, Case{"close:9", {60, 61, 62}, {29, 35, 42}},
                                         Case{"erode:32", {90, 89, 88}, {70, 67, 10}}, Case{"dilate:5", {2, 30, 2}},
                                         Case{"open:2", {30, 2, 3}}));

INSTANTIATE_TEST_SUITE_P(
    Ball, FilterBits,
    testing::Values(Case{"dilate:1:shape=ball", {41, 33, 37}}, Case{"erode:2:shape=ball", {41, 33, 37}},
                    Case{"close:1.5:shape=ball", {41, 33, 37}}, Case{"open:2.2mm:shape=ball", {41, 33, 37}},
                    Case{"dilate:1mm:shape=ball", {20, 21, 22}},
                    Case{"dilate:5:shape=ball:border=mirror", {40, 41, 42}, {25, 26, 27}},
                    Case{"erode:9:shape=ball", {44, 41, 43}, {26, 25, 27}}, Case{"dilate:3:shape=ball", {2, 30, 2}},
                    Case{"erode:3:shape=ball", {30, 2, 3}}));

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

// 1331 inner bricks are more than one submission: what is slow can be watched, and stopped in the middle of a step.
TEST(FilterChain, TellsHowFarItIsWithinAStepAndStopsThere) {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  const Volume volume = extremes({104, 104, 104});
  const BrickPool pool(gpu, transfer, volume);
  FilterChain chain(gpu, transfer, pool, lowerFilters(filterChain("erode:1:shape=ball"), volume.lattice().spacing_m));
  ASSERT_EQ(chain.steps().size(), 1U);
  std::vector<double> told;
  chain.run([&](double done) { told.push_back(done); });
  EXPECT_GE(told.size(), 4U);  // none yet, inner bricks, and those at the border
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.front(), 0);
  EXPECT_EQ(told.back(), 1);
  struct Stop {};
  int calls = 0;
  const auto stopAtTheSecond = [&](double) {
    if (++calls == 2) throw Stop{};
  };
  EXPECT_THROW(chain.run(stopAtTheSecond), Stop);
  EXPECT_EQ(calls, 2);
}

}  // namespace filter_test
}  // namespace palpate
