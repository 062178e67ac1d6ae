// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/window.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/window_pass.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace window_test {

std::vector<Sample> gather(const Volume& volume, const std::vector<std::uint32_t>& bricks, const WindowBox& box,
                           const GradientOperator& gradient_operator = {}, const SampleFormat& format = {}) {
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  const SampleStore store(gpu, pool.brickCount(), bricks, makeGpuBudget(), format);
  GradientPass(gpu, transfer, pool, store, gradient_operator).run();
  std::vector<Sample> samples(static_cast<std::size_t>(box.size.prod()));
  const gpu::Buffer window(gpu, "window", samples.size() * sizeof(Sample), gpu::MemoryKind::kHost);
  WindowPass(gpu, pool, store).run(box, window);
  std::memcpy(samples.data(), window.mapped(), window.bytes());
  return samples;
}

class WindowGather : public testing::TestWithParam<Vec3i> {};

TEST_P(WindowGather, EqualsTheTwinBitForBit) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const WindowBox box{GetParam(), volume.size().cwiseMin(kWindowEdge)};
  const std::vector<Sample> samples = gather(volume, allBricks(BrickGrid{volume.size()}), box);
  const std::vector<Sample> expected = reference::windowSamples(reference::denseField(volume), box.first, box.size);
  ASSERT_EQ(samples.size(), expected.size());
  EXPECT_EQ(std::memcmp(samples.data(), expected.data(), samples.size() * sizeof(Sample)), 0);
}

INSTANTIATE_TEST_SUITE_P(Places, WindowGather,
                         testing::Values(Vec3i(0, 0, 0), Vec3i(21, 9, 5), Vec3i(8, 8, 0), Vec3i(13, 1, 3)));

// Halves come back as the floats that they stand for; where a brick has no samples its density is the float itself.
TEST_P(WindowGather, OfHalvesEqualsTheTwinBitForBit) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const WindowBox box{GetParam(), volume.size().cwiseMin(kWindowEdge)};
  const SampleFormat format = halfSamples(0.3F, volume.minimum(), volume.maximum(), testLattice().spacing_m);
  for (const char* name : {"central", "sobel", "central4"}) {
    const GradientOperator gradient_operator = gradientOperator(name);
    const std::vector<Sample> samples =
        gather(volume, allBricks(BrickGrid{volume.size()}), box, gradient_operator, format);
    const std::vector<Sample> expected =
        reference::windowSamples(reference::denseField(volume), box.first, box.size, gradient_operator, format);
    ASSERT_EQ(samples.size(), expected.size());
    EXPECT_EQ(std::memcmp(samples.data(), expected.data(), samples.size() * sizeof(Sample)), 0) << name;
  }
  EXPECT_EQ(gather(volume, {}, box, {}, format)[0].density, volume.value(box.first));
}

TEST(WindowGather, GivesDensityWithoutGradientWhereABrickHasNone) {
  const Volume volume = ballField({40, 40, 40}, 12.0);
  const WindowBox box{{4, 4, 4}, {32, 32, 32}};
  const std::vector<Sample> samples = gather(volume, {}, box);
  for (const Vec3i& p : {Vec3i(0, 0, 0), Vec3i(16, 16, 16), Vec3i(31, 31, 31)}) {
    const Sample& sample = samples[static_cast<std::size_t>((p.z() * 32 + p.y()) * 32 + p.x())];
    EXPECT_EQ(sample.density, volume.value(p + box.first));
    EXPECT_EQ(sample.gradient_i, 0);
    EXPECT_EQ(sample.gradient_k, 0);
  }
}

TEST(WindowAround, IsCentredAndStaysInTheDomain) {
  const Vec3i domain(100, 20, 64);
  EXPECT_EQ(windowAround({50, 10, 32}, domain).first, Vec3i(34, 0, 16));
  EXPECT_EQ(windowAround({50, 10, 32}, domain).size, Vec3i(32, 20, 32));
  EXPECT_EQ(windowAround({-1e12, 10, 1e12}, domain).first, Vec3i(0, 0, 32));
  EXPECT_EQ(windowAround({99, 0, 0}, domain).first, Vec3i(68, 0, 0));
}

TEST(WindowAround, TakesItsEdge) {
  const Vec3i domain(100, 20, 64);
  EXPECT_EQ(windowAround({50, 10, 32}, domain, 8).first, Vec3i(46, 6, 28));
  EXPECT_EQ(windowAround({50, 10, 32}, domain, 8).size, Vec3i(8, 8, 8));
  EXPECT_EQ(windowAround({-1e12, 10, 1e12}, domain, 8).first, Vec3i(0, 6, 56));
}

// Three sixteenths of the edge, rounded down; at the border at once.
TEST(StillServes, UntilThePlaceIsFarFromTheMiddle) {
  const Vec3i domain(100, 100, 100);
  for (const auto& [edge, far] : {std::pair(8, 1), std::pair(11, 2), std::pair(16, 3), std::pair(32, 6)}) {
    const Vec3i size = Vec3i::Constant(edge);
    const WindowBox last{Vec3i(30, 30, 30), size};
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        const Vec3i step = sign * Vec3i::Unit(axis);
        EXPECT_TRUE(stillServes(last, {last.first + (far - 1) * step, size}, domain, edge)) << edge;
        EXPECT_FALSE(stillServes(last, {last.first + far * step, size}, domain, edge)) << edge;
      }
    }
  }
  const WindowBox near{Vec3i(1, 30, 67), Vec3i::Constant(32)};
  EXPECT_TRUE(stillServes(near, {Vec3i(2, 30, 67), near.size}, domain));
  EXPECT_FALSE(stillServes(near, {Vec3i(0, 30, 67), near.size}, domain));
  EXPECT_FALSE(stillServes(near, {Vec3i(1, 30, 68), near.size}, domain));
}

}  // namespace window_test
}  // namespace palpate
