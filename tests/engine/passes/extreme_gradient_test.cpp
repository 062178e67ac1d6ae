// SPDX-License-Identifier: Apache-2.0
// Gradients of fields of the largest numbers there are, as a no-data fill brings them, of the smallest, and of zeros:
// finite where they can be, and never NaN.
#include <cmath>
#include <cstring>
#include <optional>

#include <gtest/gtest.h>

#include "by_text.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/reference/gradient.hpp"
#include "servo/window/sample_window.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace extreme_gradient_test {

using reference::DenseField;

const Vec3i kSize(19, 17, 11);

// Gradients of all voxels.
std::vector<Sample> gradients(const Volume& volume, const GradientOperator& gradient_operator) {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  const BrickPool pool(gpu, transfer, volume);
  const SampleStore store(gpu, pool.brickCount(), allBricks(pool.grid()), makeGpuBudget(), {});
  std::optional<FilterChain> smoothing;
  if (gradient_operator.smooths()) {
    smoothing.emplace(gpu, transfer, pool, lowerFilters(gradient_operator.smoothing, pool.lattice().spacing_m));
    smoothing->run();
  }
  GradientPass(gpu, transfer, pool, store, gradient_operator, smoothing ? &smoothing->result() : nullptr).run();
  std::vector<std::byte> slab(store.slab(0).bytes());
  transfer.download(store.slab(0), slab);
  std::vector<Sample> samples;
  for (int n = 0; n < kSize.prod(); ++n) {
    const Vec3i voxel(n % kSize.x(), n / kSize.x() % kSize.y(), n / kSize.x() / kSize.y());
    const Vec3i brick = voxel / 8;
    const auto place = store.place(pool.grid().index(brick));
    const Vec3i in_brick = voxel - 8 * brick;
    const std::size_t at =
        std::size_t{place.slot} * kBrickVoxels +
        static_cast<std::size_t>((in_brick.z() * kBrickSize + in_brick.y()) * kBrickSize + in_brick.x());
    Sample sample;
    std::memcpy(&sample, slab.data() + at * sizeof sample, sizeof sample);
    samples.push_back(sample);
  }
  return samples;
}

class ExtremeGradient : public testing::TestWithParam<const char*> {};

TEST_P(ExtremeGradient, OfAConstantIsZero) {
  for (const float density : kExtremeConstants) {
    for (const Sample& sample : gradients(constantField(kSize, density), gradientOperator(GetParam()))) {
      ASSERT_TRUE(sample.gradient_i == 0 && sample.gradient_j == 0 && sample.gradient_k == 0) << density;
    }
  }
}

// Where densities differ by more than the largest float, a gradient per metre on voxels of millimetres is beyond the
// floats: infinite, with its sign, or finite, but not NaN.
TEST_P(ExtremeGradient, IsNeverNaN) {
  for (const Volume& volume : extremeFields(kSize)) {
    for (const Sample& sample : gradients(volume, gradientOperator(GetParam()))) {
      ASSERT_FALSE(std::isnan(sample.gradient_i) || std::isnan(sample.gradient_j) || std::isnan(sample.gradient_k));
      ASSERT_TRUE(std::isfinite(sample.density));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Operators, ExtremeGradient, testing::Values("central", "sobel", "central4", "gaussian:1"));

// Between neighbours of -F and F, the largest float: 8 (2 F) / 12 h, though no float holds 2 F. Six roundings.
TEST(ExtremeGradients, OfFourthOrderAreRightAcrossTwiceTheLargestFloat) {
  DenseField field;
  field.size = {5, 1, 1};
  field.lattice.spacing_m = Vec3::Constant(10);
  field.values = {0, -FLT_MAX, 0, FLT_MAX, 0};
  const GradientOperator gradient_operator = gradientOperator("central4");
  const double expected = 8 * 2.0 / (12 * 10);
  for (const float gradient : {by_text::gradientAt(field, gradient_operator, Vec3i(2, 0, 0))[0],
                               reference::gradientAt(field, gradient_operator, 2, 0, 0)[0]})
    EXPECT_NEAR(static_cast<double>(gradient) / static_cast<double>(FLT_MAX), expected, 6 * std::ldexp(1, -24));
}

// A linear field from one end of the floats to the other, on voxels of ten metres: its slope is a fortieth of the
// largest float per metre. central4 and sobel weigh differences by 8 and sums by 16, which no float holds. A dozen
// roundings.
TEST(ExtremeGradients, AreRightWhereTheyFit) {
  DenseField field;
  field.size = {9, 5, 5};
  field.lattice.spacing_m = Vec3::Constant(10);
  std::vector<float> values;
  for (int n = 0; n < field.size.prod(); ++n) values.push_back(static_cast<float>(n % 9 - 4) * (FLT_MAX / 4));
  field.values = values;
  const double slope_per_m = static_cast<double>(FLT_MAX) / 4 / 10;
  for (const char* name : {"central", "sobel", "central4"}) {
    for (int i = 1; i < 8; ++i) {
      const auto gradient = by_text::gradientAt(field, gradientOperator(name), Vec3i(i, 2, 2));
      EXPECT_NEAR(static_cast<double>(gradient[0]) / slope_per_m, 1, 12 * std::ldexp(1, -24)) << name << " " << i;
      EXPECT_EQ(gradient[1], 0) << name;
      EXPECT_EQ(gradient[2], 0) << name;
    }
  }
}

}  // namespace extreme_gradient_test
}  // namespace palpate
