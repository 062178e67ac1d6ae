// SPDX-License-Identifier: Apache-2.0
// The gradient kernels against their twins, bit for bit, and against formulas, since a twin is blind to a wrong
// formula.
#include "engine/reference/gradient.hpp"

#include <bit>
#include <cstring>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/tuning.hpp"
#include "engine/reference/half.hpp"
#include "servo/window/sample_window.hpp"
#include "test_fields.hpp"
#include "tests/engine/passes/sample_bits.hpp"

namespace palpate {
namespace gradient_test {

// Samples of every voxel of the listed bricks; the others have none.
struct Computed {
  gpu::Gpu gpu;
  gpu::Transfer transfer{gpu};
  BrickPool pool;
  SampleStore store;

  Computed(const Volume& volume, const std::vector<std::uint32_t>& bricks, const std::string& way = "central",
           const SampleFormat& format = {}, std::string_view tuned_as = "", GradientUse use = GradientUse::kOften)
      : gpu({.tuned_as = std::string(tuned_as)}),
        pool(gpu, transfer, volume),
        store(gpu, pool.brickCount(), bricks, makeGpuBudget(), format) {
    const GradientOperator made = gradientOperator(way);
    std::optional<FilterChain> smoothing;
    std::vector<FilterStep> steps = lowerFilters(made.smoothing, pool.lattice().spacing_m);
    if (!steps.empty()) smoothing.emplace(gpu, transfer, pool, std::move(steps)).run();
    GradientPass(gpu, transfer, pool, store, made, smoothing ? &smoothing->result() : nullptr, use).run();
  }
  explicit Computed(const Volume& volume, const std::string& way = "central", const SampleFormat& format = {},
                    std::string_view tuned_as = "", GradientUse use = GradientUse::kOften)
      : Computed(volume, allBricks(BrickGrid{volume.size()}), way, format, tuned_as, use) {}

  // As it is stored; of halves what they stand for, scales and all.
  Sample at(int i, int j, int k) {
    const Vec3i counts = pool.grid().counts();
    const std::size_t brick = (static_cast<std::size_t>(k / 8) * counts.y() + j / 8) * counts.x() + i / 8;
    const SampleStore::Place place = store.place(brick);
    if (slab_.empty()) {
      slab_.resize(store.slab(0).bytes());
      transfer.download(store.slab(0), slab_);
    }
    const std::size_t voxel =
        std::size_t{place.slot} * kBrickVoxels + static_cast<std::size_t>(k % 8 * 64 + j % 8 * 8 + i % 8);
    const SampleFormat& format = store.format();
    Sample sample;
    if (!format.half) {
      std::memcpy(&sample, slab_.data() + voxel * sizeof sample, sizeof sample);
      return sample;
    }
    std::array<std::uint16_t, 4> halves{};
    std::memcpy(halves.data(), slab_.data() + voxel * sizeof halves, sizeof halves);
    const auto gradient = [&](std::uint16_t half) { return reference::fromHalf(half) / format.code.gradient_scale; };
    return {gradient(halves[0]), gradient(halves[1]), gradient(halves[2]),
            reference::fromHalf(halves[3]) / format.code.density_scale + format.code.zero};
  }

 private:
  std::vector<std::byte> slab_;
};

void expectEqualsTwin(const Volume& volume, const std::string& way, const SampleFormat& format,
                      std::string_view tuned_as = "", GradientUse use = GradientUse::kOften) {
  Computed run(volume, way, format, tuned_as, use);
  const GradientOperator made = gradientOperator(way);
  const reference::DenseField field = reference::denseField(volume);
  const reference::DenseField smoothed = reference::smoothedFor(made, field);
  std::size_t differing = 0;
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        const auto expected = reference::gradientAt(smoothed, made, i, j, k);
        const Sample want = reference::stored({expected[0], expected[1], expected[2], field.at(i, j, k)}, format);
        const Sample got = run.at(i, j, k);
        using Words = std::array<std::uint32_t, 4>;
        const auto a = std::bit_cast<Words>(got);
        const auto b = std::bit_cast<Words>(want);
        for (std::size_t c = 0; c < 4; ++c) differing += a[c] != b[c] ? 1U : 0U;
      }
    }
  }
  EXPECT_EQ(differing, 0U) << way << (format.half ? ", halves" : "");
}

struct BitsCase {
  Vec3i size;
  const char* way;
};
class GradientBits : public testing::TestWithParam<BitsCase> {};

TEST_P(GradientBits, EqualTheTwinOnABall) {
  const Volume volume = ballField(GetParam().size, 9.0);
  expectEqualsTwin(volume, GetParam().way, {});
  expectEqualsTwin(volume, GetParam().way, halfSamples(0.3F, -3, 3, testLattice().spacing_m));
}

// Halves then hold next to nothing but 65504 and 0; with a
// scale for ordinary values, the others overflow and vanish.
TEST_P(GradientBits, EqualTheTwinOnExtremes) {
  const Volume volume = extremes(GetParam().size);
  expectEqualsTwin(volume, GetParam().way, {});
  expectEqualsTwin(volume, GetParam().way, halfSamples(0.1F, -1e30F, 1e30F, testLattice().spacing_m));
  expectEqualsTwin(volume, GetParam().way, halfSamples(0.1F, -1, 1, testLattice().spacing_m));
}

std::vector<BitsCase> bitsCases() {
  std::vector<BitsCase> cases;
  for (const char* way : {"central", "sobel", "central4", "gaussian:1.2mm", "gaussian:2:border=mirror:truncate=4"}) {
    for (const Vec3i& size : {Vec3i(41, 33, 37), Vec3i(8, 8, 8), Vec3i(9, 7, 2), Vec3i(2, 2, 2), Vec3i(3, 2, 17),
                              Vec3i(16, 17, 15), Vec3i(1, 9, 17), Vec3i(9, 1, 17), Vec3i(17, 9, 1), Vec3i(1, 1, 1)})
      cases.push_back({size, way});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Sizes, GradientBits, testing::ValuesIn(bitsCases()));

// No tuning changes a bit.
class GradientTuned : public testing::TestWithParam<Tuning> {};
TEST_P(GradientTuned, EqualsTheTwin) {
  const std::string_view kind = GetParam().device.empty() ? "discrete" : GetParam().device;
  for (const char* way : {"central", "central4", "gaussian:1"}) {
    for (const Vec3i& size : {Vec3i(41, 33, 37), Vec3i(9, 7, 2), Vec3i(3, 2, 17)}) {
      for (const GradientUse use : {GradientUse::kOften, GradientUse::kOnce}) {
        expectEqualsTwin(ballField(size, 9.0), way, {}, kind, use);
        expectEqualsTwin(ballField(size, 9.0), way, halfSamples(0.3F, -3, 3, testLattice().spacing_m), kind, use);
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Devices, GradientTuned, testing::ValuesIn(tunings().begin(), tunings().end()));

// Only some bricks have samples, and those are as if all had: nothing of a kernel depends on the bricks in its list.
TEST(Gradient, OfSomeBricksIsAsOfAll) {
  const Volume volume = ballField({41, 33, 37}, 9.0);
  for (const char* way : {"sobel", "central4", "gaussian:1"}) {
    Computed all(volume, way);
    Computed some(volume, std::vector<std::uint32_t>{7, 31, 32, 33, 45}, way);
    for (const Vec3i& p : {Vec3i(8, 8, 8), Vec3i(15, 15, 15), Vec3i(12, 10, 9)}) {
      const Vec3i counts = volume.brickCount();
      const Vec3i b = p / 8;
      if (!some.store.has((static_cast<std::size_t>(b.z()) * counts.y() + b.y()) * counts.x() + b.x())) continue;
      EXPECT_EQ(some.at(p.x(), p.y(), p.z()).gradient_j, all.at(p.x(), p.y(), p.z()).gradient_j) << way;
    }
    EXPECT_EQ(some.store.brickCount(), 5U);
  }
}

// A linear field a + b.x has the gradient b everywhere, border included. Values are small integers and sums of them
// exact, so only the scale's rounding (half an ULP) and the product's remain: one ULP, 1.2e-7 relative.
TEST(Gradient, IsExactOnALinearField) {
  const Vec3i size(19, 18, 11);
  const Volume volume = makeField(size, [](int i, int j, int k) { return static_cast<float>(3 * i - 5 * j + 7 * k); });
  const Vec3 h = testLattice().spacing_m;
  for (const char* way : {"central", "sobel", "central4"}) {
    Computed run(volume, way);
    for (int k = 0; k < size.z(); ++k) {
      for (int j = 0; j < size.y(); ++j) {
        for (int i = 0; i < size.x(); ++i) {
          const Sample sample = run.at(i, j, k);
          ASSERT_NEAR(sample.gradient_i, 3 / h.x(), 3 / h.x() * 1.2e-7) << way << " " << i << " " << j << " " << k;
          ASSERT_NEAR(sample.gradient_j, -5 / h.y(), 5 / h.y() * 1.2e-7) << way << " " << i << " " << j << " " << k;
          ASSERT_NEAR(sample.gradient_k, 7 / h.z(), 7 / h.z() * 1.2e-7) << way << " " << i << " " << j << " " << k;
          ASSERT_EQ(sample.density, static_cast<float>(3 * i - 5 * j + 7 * k)) << way;
        }
      }
    }
  }
}

// The Gaussian of a linear field is the field, away from the border by the kernel's reach of 3 voxels, and ended there.
// Along each axis 7 products and 6 sums round a value of at most 180 by 2^-24 of it each, the taps' sum is as far
// from 1: 3 x 14 x 2^-24 x 180 = 4.5e-4 at most in the smoothed field, and as much in half the sum of two of them.
TEST(Gradient, OfAGaussianIsExactOnALinearFieldInside) {
  const Vec3i size(19, 18, 17);
  Computed run(makeField(size, [](int i, int j, int k) { return static_cast<float>(3 * i - 5 * j + 7 * k); }),
               "gaussian:1");
  const Vec3 h = testLattice().spacing_m;
  for (const Vec3i& p : {Vec3i(4, 4, 4), Vec3i(14, 13, 12), Vec3i(8, 7, 8), Vec3i(7, 8, 7)}) {
    const Sample sample = run.at(p.x(), p.y(), p.z());
    EXPECT_NEAR(sample.gradient_i * h.x(), 3, 4.6e-4);
    EXPECT_NEAR(sample.gradient_j * h.y(), -5, 4.6e-4);
    EXPECT_NEAR(sample.gradient_k * h.z(), 7, 4.6e-4);
    EXPECT_EQ(sample.density, static_cast<float>(3 * p.x() - 5 * p.y() + 7 * p.z()));  // not the smoothed one
  }
}

// On f = x^2 (x in voxels) central differences are exact inside, 2x/h; at the border the one-sided difference gives
// f(1) - f(0) = 1 and f(n-1) - f(n-2) = 2n - 3, first order: forward or backward differences inside would give 2x +- 1.
TEST(Gradient, IsCentralInsideAndOneSidedAtTheBorder) {
  for (const char* way : {"central", "sobel", "central4"}) {
    Computed run(makeField({12, 9, 9}, [](int i, int, int) { return static_cast<float>(i * i); }), way);
    const double h = testLattice().spacing_m.x();
    const auto inVoxels = [&](int i) { return run.at(i, 4, 4).gradient_i * h; };
    EXPECT_NEAR(inVoxels(0), 1, 1e-6) << way;
    for (int i = 1; i < 11; ++i) EXPECT_NEAR(inVoxels(i), 2 * i, 2e-7 * 2 * i) << way;
    EXPECT_NEAR(inVoxels(11), 21, 21 * 2e-7) << way;
  }
}

// On f = x^3 the central difference gives 3x^2 + 1, the fourth-order one 3x^2 from the third voxel on: beside the
// border it is the central one.
TEST(Gradient, IsOfFourthOrderFromTheThirdVoxelOn) {
  const auto cube = [](int c) { return static_cast<float>(c * c * c); };
  const Vec3 h = testLattice().spacing_m;
  for (int axis = 0; axis < 3; ++axis) {
    Computed run(makeField({19, 19, 19}, [&](int i, int j, int k) { return cube(axis == 0   ? i
                                                                                : axis == 1 ? j
                                                                                            : k); }),
                 "central4");
    const auto inVoxels = [&](int c) {
      Vec3i p(9, 9, 9);
      p[axis] = c;
      const Sample sample = run.at(p.x(), p.y(), p.z());
      return (axis == 0 ? sample.gradient_i : axis == 1 ? sample.gradient_j : sample.gradient_k) * h[axis];
    };
    EXPECT_NEAR(inVoxels(1), 4, 1e-6) << axis;
    EXPECT_NEAR(inVoxels(17), 3 * 17 * 17 + 1, 868 * 2e-7) << axis;
    for (int c = 2; c < 17; ++c) EXPECT_NEAR(inVoxels(c), 3 * c * c, 3 * c * c * 2e-7) << axis << " " << c;
  }
}

// Across the axis Sobel weighs 1, 2, 1 of four, beyond the border the outermost voxel again: of f = x y it gives y
// inside and (0 + 2 x 0 + 1) / 4 at y = 0; of x z likewise.
TEST(Gradient, OfSobelRepeatsTheOutermostVoxelAcrossTheAxis) {
  Computed run(makeField({17, 17, 17}, [](int i, int j, int k) { return static_cast<float>(i * j + 100 * i * k); }),
               "sobel");
  const double h = testLattice().spacing_m.x();
  EXPECT_NEAR(run.at(8, 0, 0).gradient_i * h, 0.25 + 25, 26 * 2e-7);
  EXPECT_NEAR(run.at(8, 7, 0).gradient_i * h, 7 + 25, 32 * 2e-7);
  EXPECT_NEAR(run.at(8, 16, 8).gradient_i * h, 15.75 + 800, 816 * 2e-7);
  EXPECT_NEAR(run.at(7, 8, 8).gradient_i * h, 808, 808 * 2e-7);
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

// One voxel that changes: samples change as far as reach() says, which edits rely on, and no further.
TEST(Gradient, ReachesAsFarAsItSays) {
  const Vec3i size(29, 28, 27);
  const Vec3i at(14, 13, 12);
  const auto field = [&](float there) {
    return makeField(size, [=](int i, int j, int k) {
      return Vec3i(i, j, k) == at ? there : static_cast<float>((i * 7 + j * 5 + k * 3) % 11);
    });
  };
  for (const char* way : {"central", "sobel", "central4"}) {
    Computed before(field(1), way);
    Computed after(field(2), way);
    int farthest = 0;
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i p(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      const Sample a = before.at(p.x(), p.y(), p.z());
      const Sample b = after.at(p.x(), p.y(), p.z());
      if (!sameBits(a, b)) farthest = std::max(farthest, (p - at).cwiseAbs().maxCoeff());
    }
    const Reach reach =
        GradientPass(before.gpu, before.transfer, before.pool, before.store, gradientOperator(way)).reach();
    EXPECT_EQ(farthest, reach.low) << way;
    EXPECT_EQ(farthest, reach.high) << way;
  }
}

TEST(SampleStore, HasNoPlaceForBricksThatWereNotAsked) {
  Computed run(ballField({24, 24, 24}, 9.0), std::vector<std::uint32_t>{5, 7});
  EXPECT_EQ(run.store.place(5).slot, 0U);
  EXPECT_EQ(run.store.place(7).slot, 1U);
  EXPECT_EQ(run.store.place(6).slot, NO_SLOT);
  EXPECT_EQ(run.store.bytes(), 2U * 512U * 16U);
}

TEST(SampleStore, TakesHalfTheMemoryForHalves) {
  Computed run(ballField({24, 24, 24}, 9.0), std::vector<std::uint32_t>{5, 7}, "central",
               halfSamples(0, -3, 3, testLattice().spacing_m));
  EXPECT_EQ(run.store.bytes(), 2U * 512U * 8U);
}

}  // namespace gradient_test
}  // namespace palpate
