// SPDX-License-Identifier: Apache-2.0
// What median and morphology must do whatever computes them: each test runs on the twin and on the kernels. All of it
// is exact, since every result is one of the values that are there.

#include <cmath>

#include <gtest/gtest.h>

#include "engine/reference/filter.hpp"
#include "filtered_fields.hpp"

namespace palpate {
namespace rank_filter_test {

using reference::DenseField;

enum class By { kTwin, kKernels };
class RankFilter : public testing::TestWithParam<By> {
 protected:
  static DenseField filtered(const Volume& volume, const std::string& chain) {
    const auto steps = lowerFilters(filterChain(chain), testLattice().spacing_m);
    return GetParam() == By::kKernels ? filteredOnGpu(volume, steps)
                                      : reference::applyFilters(reference::denseField(volume), steps);
  }
};
INSTANTIATE_TEST_SUITE_P(By, RankFilter, testing::Values(By::kTwin, By::kKernels),
                         [](const auto& by) { return by.param == By::kTwin ? "twin" : "kernels"; });

constexpr const char* kShapes[] = {":1", ":2:shape=ball", ":5:border=mirror", ":1.5mm", ":2mm:shape=ball"};

template <typename Map>
Volume mapped(const DenseField& field, Map map) {
  return makeField(field.size, [&](int i, int j, int k) { return map(field.at(i, j, k)); });
}

Volume integers(const Vec3i& size, int highest) {
  std::mt19937 random(5);
  return makeField(size, [&](int, int, int) { return static_cast<float>(random() % (highest + 1)); });
}

bool ordered(float a, float b) {
  return a < b || (a == b && (std::signbit(a) || !std::signbit(b)));
}

// How many voxels of `a` lie above those of `b`.
std::size_t above(const DenseField& a, const DenseField& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) count += ordered(a.values[i], b.values[i]) ? 0U : 1U;
  return count;
}

TEST_P(RankFilter, OpeningAndClosingTwiceIsOnce) {
  const Volume volume = extremes({19, 18, 21});
  for (const std::string shape : kShapes) {
    for (const std::string name : {"open", "close"}) {
      const DenseField once = filtered(volume, name + shape);
      EXPECT_EQ(differing(filtered(mapped(once, [](float f) { return f; }), name + shape), once), 0U) << name << shape;
      EXPECT_GT(differing(once, reference::denseField(volume)), once.values.size() / 2);
    }
  }
}

TEST_P(RankFilter, ErodingIsDilatingTheNegative) {
  const Volume volume = extremes({19, 18, 21});
  const auto negative = [](float f) { return -f; };
  const Volume negated = mapped(reference::denseField(volume), negative);
  for (const std::string shape : kShapes) {
    const Volume back = mapped(filtered(negated, "dilate" + shape), negative);
    EXPECT_EQ(differing(filtered(volume, "erode" + shape), reference::denseField(back)), 0U) << shape;
  }
}

TEST_P(RankFilter, ErodedOpenedFieldClosedDilatedAreInOrder) {
  const Volume volume = extremes({19, 18, 21});
  const DenseField field = reference::denseField(volume);
  for (const std::string shape : kShapes) {
    const DenseField opened = filtered(volume, "open" + shape), closed = filtered(volume, "close" + shape);
    EXPECT_EQ(above(filtered(volume, "erode" + shape), opened), 0U) << shape;
    EXPECT_EQ(above(opened, field), 0U) << shape;
    EXPECT_EQ(above(field, closed), 0U) << shape;
    EXPECT_EQ(above(closed, filtered(volume, "dilate" + shape)), 0U) << shape;
  }
}

// An impulse grows to the voxels whose centres are at most the radius away: straight for a ball, along each axis for a
// box.
TEST_P(RankFilter, AnImpulseGrowsToTheShape) {
  const Vec3i size(25, 26, 27), middle(12, 13, 11);
  const Vec3 spacing_m = testLattice().spacing_m;
  const Volume impulse = makeField(size, [&](int i, int j, int k) { return Vec3i(i, j, k) == middle ? 3.0F : -2.0F; });
  const auto expect = [&](const char* chain, auto holds) {
    const DenseField grown = filtered(impulse, chain);
    std::size_t wrong = 0;
    for (int k = 0; k < size.z(); ++k) {
      for (int j = 0; j < size.y(); ++j) {
        for (int i = 0; i < size.x(); ++i) {
          const Vec3 away = (Vec3i(i, j, k) - middle).cast<double>();
          wrong += grown.at(i, j, k) == (holds(away) ? 3.0F : -2.0F) ? 0U : 1U;
        }
      }
    }
    EXPECT_EQ(wrong, 0U) << chain;
  };
  const auto metres = [&](const Vec3& away) { return Vec3(away.cwiseProduct(spacing_m)); };
  expect("dilate:2", [](const Vec3& away) { return away.cwiseAbs().maxCoeff() <= 2; });
  expect("dilate:2.5mm", [&](const Vec3& away) { return metres(away).cwiseAbs().maxCoeff() <= 2.5e-3; });
  expect("dilate:3:shape=ball", [](const Vec3& away) { return away.squaredNorm() <= 9; });
  expect("dilate:2.5mm:shape=ball", [&](const Vec3& away) { return metres(away).norm() <= 2.5e-3; });
  expect("dilate:5mm:shape=ball", [&](const Vec3& away) { return metres(away).norm() <= 5e-3; });
  expect("erode:1:shape=ball", [](const Vec3&) { return false; });
  expect("median:1", [](const Vec3&) { return false; });
  // A box or ball that the impulse has grown to is taken away again, and no more than it.
  expect("close:2", [](const Vec3& away) { return away.isZero(); });
  expect("close:2mm:shape=ball", [](const Vec3& away) { return away.isZero(); });
}

// More than half of a window stands on its middle voxel's side of a plane across an axis.
TEST_P(RankFilter, MedianKeepsAStep) {
  for (int axis = 0; axis < 3; ++axis) {
    const Volume step =
        makeField({17, 18, 19}, [&](int i, int j, int k) { return Vec3i(i, j, k)[axis] < 9 ? -1000.0F : 0.5F; });
    for (const char* chain : {"median:1", "median:2", "median:3", "median:1.4mm", "median:1:border=mirror"}) {
      EXPECT_EQ(differing(filtered(step, chain), reference::denseField(step)), 0U) << chain << " " << axis;
    }
  }
}

// At a corner the nearest voxel is repeated eight times of 27, which is fewer than half.
TEST_P(RankFilter, MedianRemovesSingleOutliers) {
  const Volume outliers = makeField(
      {17, 18, 21}, [](int i, int j, int k) { return i % 4 == 0 && j % 4 == 1 && k % 4 == 0 ? 1e30F : 7.25F; });
  const DenseField clean = filtered(outliers, "median:1");
  for (const float value : clean.values) EXPECT_EQ(value, 7.25F);
}

// The value in a place of the order is mapped as all values are. Cubes of numbers up to 200 are exact in a float.
TEST_P(RankFilter, CommutesWithARisingMap) {
  const Volume volume = integers({18, 17, 21}, 200);
  const auto cube = [](float f) { return f * f * f - 4096.0F; };
  const Volume cubes = mapped(reference::denseField(volume), cube);
  for (const char* chain : {"median:1", "median:2", "median:3", "dilate:1", "erode:2:shape=ball"}) {
    const Volume after = mapped(filtered(volume, chain), cube);
    EXPECT_EQ(differing(filtered(cubes, chain), reference::denseField(after)), 0U) << chain;
  }
}

// As many values of the window stand below the median as above it, counted one by one.
TEST_P(RankFilter, MedianStandsInTheMiddle) {
  const Volume volume = integers({17, 16, 15}, 60);
  const DenseField field = reference::denseField(volume), median = filtered(volume, "median:1");
  for (int k = 1; k < 14; ++k) {
    for (int j = 1; j < 15; ++j) {
      for (int i = 1; i < 16; ++i) {
        int below = 0, up_to = 0;
        for (int n = 0; n < 27; ++n) {
          const float value = field.at(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1);
          below += value < median.at(i, j, k) ? 1 : 0;
          up_to += value <= median.at(i, j, k) ? 1 : 0;
        }
        EXPECT_LE(below, 13);
        EXPECT_GE(up_to, 14);
      }
    }
  }
}

// Windows that reach nothing along one axis or two, whichever they are.
TEST(RankKernels, FlatWindowsEqualTheTwin) {
  const Volume volume = extremes({27, 26, 29});
  const DenseField field = reference::denseField(volume);
  for (const Vec3& spacing_mm : {Vec3(2, 1, 0.6), Vec3(0.5, 0.5, 1.2), Vec3(0.5, 2, 0.6), Vec3(2, 2, 0.5)}) {
    for (const char* chain : {"median:1mm", "median:1.2mm:border=mirror", "erode:1.1mm", "dilate:1.3mm:shape=ball"}) {
      const auto steps = lowerFilters(filterChain(chain), spacing_mm * 1e-3);
      EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(field, steps)), 0U)
          << chain << " on " << spacing_mm.transpose();
    }
  }
}

// A window cut off at the border holds the same extremes as one continued by mirroring.
TEST(RankTwin, BordersShowNoNewExtremes) {
  const DenseField field = reference::denseField(extremes({7, 6, 9}));
  for (const char* chain : {"dilate:4", "erode:2:shape=ball", "dilate:4mm:shape=ball"}) {
    for (FilterStep step : lowerFilters(filterChain(chain), testLattice().spacing_m)) {
      EXPECT_EQ(step.border, Border::kNearest);
      const DenseField nearest = reference::applyStep(field, step);
      step.border = Border::kMirror;
      EXPECT_EQ(differing(reference::applyStep(field, step), nearest), 0U) << chain;
    }
  }
}

}  // namespace rank_filter_test
}  // namespace palpate
