// SPDX-License-Identifier: Apache-2.0
// Fields of the largest numbers there are, as a no-data fill brings them, of the smallest, and of zeros: what comes out
// of the kernels is what the twins say, finite where it can be, and never NaN.
#include <cmath>
#include <cstring>

#include "by_text.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/reference/gradient.hpp"
#include "filtered_fields.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace extreme_field_test {

using reference::DenseField;

const Vec3i kSize(19, 17, 11);

std::vector<Volume> fields() {
  std::vector<Volume> volumes;
  volumes.push_back(extremes(kSize));
  volumes.push_back(largest(kSize));
  // A fill around a body, and one step between the two ends of the floats.
  volumes.push_back(makeField(kSize, [](int i, int j, int k) {
    return (Vec3i(i, j, k) - kSize / 2).squaredNorm() < 25 ? static_cast<float>(i + j) : -FLT_MAX;
  }));
  volumes.push_back(makeField(kSize, [](int i, int, int) { return i < 9 ? FLT_MAX : -FLT_MAX; }));
  return volumes;
}

constexpr float kConstants[] = {FLT_MAX, -FLT_MAX, 1e-45F, -0.0F};

class ExtremeFilter : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<FilterStep> steps() {
    return lowerFilters(filterChain(GetParam()), testLattice().spacing_m, 0.25F);
  }
};

// Of these sigmas the taps times the largest float add up to more than it, by their roundings.
TEST_P(ExtremeFilter, IsFiniteAndAsTheTextSays) {
  for (const Volume& volume : fields()) {
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
    for (const float density : kConstants) {
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

// Gradients of all voxels.
std::vector<Sample> gradients(const Volume& volume, const GradientOperator& way) {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  const BrickPool pool(gpu, transfer, volume);
  const SampleStore store(gpu, pool.brickCount(), allBricks(pool.grid()), makeGpuBudget(), {});
  std::optional<FilterChain> smoothing;
  if (way.smooths()) {
    smoothing.emplace(gpu, transfer, pool, lowerFilters(way.smoothing, pool.lattice().spacing_m));
    smoothing->run();
  }
  GradientPass(gpu, transfer, pool, store, way, smoothing ? &smoothing->result() : nullptr).run();
  std::vector<std::byte> slab(store.slab(0).bytes());
  transfer.download(store.slab(0), slab);
  std::vector<Sample> samples;
  for (int n = 0; n < kSize.prod(); ++n) {
    const Vec3i voxel(n % kSize.x(), n / kSize.x() % kSize.y(), n / kSize.x() / kSize.y());
    const Vec3i brick = voxel / 8;
    const Vec3i counts = pool.grid().counts();
    const auto place = store.place(static_cast<std::size_t>((brick.z() * counts.y() + brick.y()) * counts.x()) +
                                   static_cast<std::size_t>(brick.x()));
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
  for (const float density : kConstants) {
    for (const Sample& sample : gradients(constantField(kSize, density), gradientOperator(GetParam()))) {
      ASSERT_TRUE(sample.gradient_i == 0 && sample.gradient_j == 0 && sample.gradient_k == 0) << density;
    }
  }
}

// Where densities differ by more than the largest float, a gradient per metre on voxels of millimetres is beyond the
// floats: infinite, with its sign, or finite, but not NaN.
TEST_P(ExtremeGradient, IsNeverNaN) {
  for (const Volume& volume : fields()) {
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
  const GradientOperator way = gradientOperator("central4");
  const double expected = 8 * 2.0 / (12 * 10);
  for (const float gradient :
       {by_text::gradientAt(field, way, Vec3i(2, 0, 0))[0], reference::gradientAt(field, way, 2, 0, 0)[0]})
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

}  // namespace extreme_field_test
}  // namespace palpate
