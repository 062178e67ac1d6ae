// SPDX-License-Identifier: Apache-2.0
// The gradient kernel against its twin, bit for bit, and against formulas, since a twin is blind to a wrong formula.
#include "engine/reference/gradient.hpp"

#include <bit>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "engine/passes/active_bricks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "servo/window/sample_window.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace {

// Samples of every voxel of the listed bricks; voxels of others stay NaN.
struct Computed {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  BrickPool pool;
  SampleStore store;

  Computed(const Volume& volume, const std::vector<std::uint32_t>& bricks)
      : pool(gpu, transfer, volume), store(gpu, pool.brickCount(), bricks) {
    GradientPass(gpu, transfer, pool, store).run();
  }
  explicit Computed(const Volume& volume) : Computed(volume, allBricks(volume.brickCount())) {}

  Sample at(int i, int j, int k) {
    const Vec3i counts = pool.brickCounts();
    const std::size_t brick = (static_cast<std::size_t>(k / 8) * counts.y() + j / 8) * counts.x() + i / 8;
    const SampleStore::Place place = store.place(brick);
    if (slab_.empty()) {
      slab_.resize(store.slab(0).bytes() / sizeof(Sample));
      transfer.download(store.slab(0), std::as_writable_bytes(std::span(slab_)));
    }
    return slab_[std::size_t{place.slot} * kBrickVoxels + static_cast<std::size_t>(k % 8 * 64 + j % 8 * 8 + i % 8)];
  }

 private:
  std::vector<Sample> slab_;
};

void expectEqualsTwin(const Volume& volume) {
  Computed run(volume);
  const reference::DenseField field = reference::denseField(volume);
  std::size_t differing = 0;
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        const auto expected = reference::gradientAt(field, i, j, k);
        const Sample sample = run.at(i, j, k);
        const float got[4] = {sample.gradient_i, sample.gradient_j, sample.gradient_k, sample.density};
        const float want[4] = {expected[0], expected[1], expected[2], field.at(i, j, k)};
        for (int c = 0; c < 4; ++c) {
          differing += std::bit_cast<std::uint32_t>(got[c]) != std::bit_cast<std::uint32_t>(want[c]) ? 1U : 0U;
        }
      }
    }
  }
  EXPECT_EQ(differing, 0U);
}

class GradientBits : public testing::TestWithParam<Vec3i> {};

TEST_P(GradientBits, EqualTheTwinOnABall) {
  expectEqualsTwin(ballField(GetParam(), 9.0));
}

// Denormals, 1e-30, 1e30 and ordinary values side by side.
TEST_P(GradientBits, EqualTheTwinOnExtremes) {
  std::mt19937 random(11);
  const float scales[] = {1.0F, 1e30F, 1e-30F, 1e-40F, 1e-45F, 0.0F};
  expectEqualsTwin(makeField(GetParam(), [&](int, int, int) {
    const float unit = static_cast<float>(random()) / 4294967296.0F * 2.0F - 1.0F;
    return unit * scales[random() % std::size(scales)];
  }));
}

INSTANTIATE_TEST_SUITE_P(Sizes, GradientBits,
                         testing::Values(Vec3i(41, 33, 37), Vec3i(8, 8, 8), Vec3i(9, 7, 2), Vec3i(2, 2, 2),
                                         Vec3i(16, 17, 15)));

// A linear field a + b.x has the gradient b everywhere, border included. Values are small integers and the differences
// exact, so only the scale's rounding (half an ULP) and the product's remain: one ULP, 1.2e-7 relative.
TEST(Gradient, IsExactOnALinearField) {
  const Vec3i size(19, 18, 11);
  Computed run(makeField(size, [](int i, int j, int k) { return static_cast<float>(3 * i - 5 * j + 7 * k); }));
  const Vec3 h = testLattice().spacing_m;
  for (const Vec3i& p : {Vec3i(0, 0, 0), Vec3i(18, 17, 10), Vec3i(8, 7, 8), Vec3i(7, 8, 7), Vec3i(3, 17, 0)}) {
    const Sample sample = run.at(p.x(), p.y(), p.z());
    EXPECT_NEAR(sample.gradient_i, 3 / h.x(), 3 / h.x() * 1.2e-7);
    EXPECT_NEAR(sample.gradient_j, -5 / h.y(), 5 / h.y() * 1.2e-7);
    EXPECT_NEAR(sample.gradient_k, 7 / h.z(), 7 / h.z() * 1.2e-7);
    EXPECT_EQ(sample.density, static_cast<float>(3 * p.x() - 5 * p.y() + 7 * p.z()));
  }
}

// On f = x^2 (x in voxels) the central difference is exact inside, 2x/h; at the border the one-sided difference gives
// f(1) - f(0) = 1 and f(n-1) - f(n-2) = 2n - 3, first order: forward or backward differences inside would give 2x +- 1.
TEST(Gradient, IsCentralInsideAndOneSidedAtTheBorder) {
  Computed run(makeField({12, 9, 9}, [](int i, int, int) { return static_cast<float>(i * i); }));
  const double h = testLattice().spacing_m.x();
  const auto inVoxels = [&](int i) { return run.at(i, 4, 4).gradient_i * h; };
  EXPECT_NEAR(inVoxels(0), 1, 1e-6);
  for (int i = 1; i < 11; ++i) EXPECT_NEAR(inVoxels(i), 2 * i, 2e-7 * 2 * i);
  EXPECT_NEAR(inVoxels(11), 21, 21 * 2e-7);
}

// Bricks that hold one value have no storage; gradients across their faces still come from both sides.
TEST(Gradient, SeesAcrossConstantBricks) {
  const Volume volume = makeField({24, 8, 8}, [](int i, int, int) { return i < 8 ? 0.0F : i < 16 ? 4.0F : 10.0F; });
  EXPECT_EQ(volume.storedBricks(), 0U);
  Computed run(volume);
  const double h = testLattice().spacing_m.x();
  EXPECT_NEAR(run.at(7, 3, 3).gradient_i * h, 2, 1e-6);
  EXPECT_NEAR(run.at(8, 3, 3).gradient_i * h, 2, 1e-6);
  EXPECT_NEAR(run.at(15, 3, 3).gradient_i * h, 3, 1e-6);
  EXPECT_EQ(run.at(12, 3, 3).gradient_i, 0);
}

TEST(SampleStore, HasNoPlaceForBricksThatWereNotAsked) {
  Computed run(ballField({24, 24, 24}, 9.0), {5, 7});
  EXPECT_EQ(run.store.place(5).slot, 0U);
  EXPECT_EQ(run.store.place(7).slot, 1U);
  EXPECT_EQ(run.store.place(6).slot, NO_SLOT);
  EXPECT_EQ(run.store.bytes(), 2U * 512U * 16U);
}

}  // namespace
}  // namespace palpate
