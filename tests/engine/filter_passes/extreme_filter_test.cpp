// SPDX-License-Identifier: Apache-2.0
// Filters of fields of the largest numbers there are, as a no-data fill brings them, of the smallest, and of zeros:
// what comes out of the kernels is what their text says, and finite.
#include <cmath>

#include "filtered_fields.hpp"
#include "filters_by_text.hpp"

namespace palpate {
namespace extreme_filter_test {

using reference::DenseField;

const Vec3i kSize(19, 17, 11);

class ExtremeFilter : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<FilterStep> steps() {
    return lowerFilters(filterChain(GetParam()), testLattice().spacing_m, 0.25F);
  }
};

// Of these sigmas the taps times the largest float add up to more than it, by their roundings.
TEST_P(ExtremeFilter, IsFiniteAndAsTheTextSays) {
  for (const Volume& volume : extremeFields(kSize)) {
    const DenseField after = filteredOnGpu(volume, steps());
    EXPECT_EQ(notFinite(after), 0U);
    EXPECT_EQ(differing(after, by_text::filtered(reference::denseField(volume), steps())), 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, ExtremeFilter,
                         testing::Values("gaussian:0.85", "gaussian:1.8", "gaussian:2.3:border=mirror",
                                         "gaussian:0.6 gaussian:3.4", "bilateral:1:range=1e30",
                                         "bilateral:1:range=1e-30", "bilateral:1.5:range=100:border=mirror",
                                         "diffuse:3:kappa=1e30", "diffuse:2:kappa=1e-30", "diffuse:3:kappa=1e30:g=exp",
                                         "diffuse:2:kappa=1:g=exp", "median:1", "median:2", "median:3", "dilate:2",
                                         "erode:2:shape=ball", "close:1", "distance:3", "distance:6"));

// A constant is pages without storage, of which the host says what becomes of them (uniformResult): what the kernels
// would make of them.
TEST(ExtremeFilters, MakeOfAConstantWhatTheTextDoes) {
  for (const char* chain : {"gaussian:1.8", "gaussian:2.3:border=mirror", "gaussian:0.6 gaussian:3.4",
                            "bilateral:1:range=1e30", "diffuse:3:kappa=1e30", "median:1", "close:1", "distance:3"}) {
    const auto steps = lowerFilters(filterChain(chain), testLattice().spacing_m, 0.25F);
    for (const float density : kExtremeConstants) {
      const Volume volume = constantField(kSize, density);
      const DenseField after = filteredOnGpu(volume, steps);
      EXPECT_EQ(notFinite(after), 0U) << chain << " of " << density;
      EXPECT_EQ(differing(after, by_text::filtered(reference::denseField(volume), steps)), 0U)
          << chain << " of " << density;
    }
  }
}

// Powers of two change no bit of a surface point, a normal or a distance, as long as no difference is a denormal: the
// field's smallest, 2^-24 of a voxel, is one below 2^-100; its largest is 6 voxels.
TEST(ExtremeDistance, DoesNotDependOnTheDensitysScale) {
  const Vec3i size(29, 27, 25);
  const auto steps = lowerFilters(filterChain("distance:4"), testLattice().spacing_m, 0.0F);
  const DenseField ball = reference::denseField(ballField(size, 9.0));
  const DenseField expected = filteredOnGpu(ballField(size, 9.0), steps);
  for (const int power : {66, 125, -60, -100}) {
    const Volume scaled = makeField(size, [&](int i, int j, int k) { return std::ldexp(ball.at(i, j, k), power); });
    EXPECT_EQ(differing(filteredOnGpu(scaled, steps), expected), 0U) << "2^" << power;
  }
}

}  // namespace extreme_filter_test
}  // namespace palpate
