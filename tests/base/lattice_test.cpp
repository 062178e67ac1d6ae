// SPDX-License-Identifier: Apache-2.0
#include "base/lattice.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace lattice_test {

Lattice oblique() {
  Lattice lattice;
  lattice.origin_W = {0.1, -0.2, 0.05};
  lattice.R_WL = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  lattice.R_WL.col(2) *= -1;  // left-handed, as a scan with reversed slices
  lattice.spacing_m = {0.5e-3, 0.7e-3, 2.0e-3};
  return lattice;
}

// Positions of some 0.3 m with spacings of some 1e-3 m: a dozen roundings of 1e-16 relative, over 1e-3: 1e-12 voxel.
TEST(Lattice, IndexAndWorldAreInverse) {
  const Vec3 p_L(3.25, -7.5, 40);
  EXPECT_LT((oblique().toIndex(oblique().toWorld(p_L)) - p_L).norm(), 1e-11);
}

TEST(Lattice, WorldIsOriginPlusStepsAlongTheAxes) {
  const Lattice lattice = oblique();
  const Vec3 step_W = lattice.toWorld({0, 1, 0}) - lattice.toWorld({0, 0, 0});
  EXPECT_LT((step_W - 0.7e-3 * lattice.R_WL.col(1)).norm(), 1e-16);
  EXPECT_EQ(lattice.toWorld(Vec3::Zero()), lattice.origin_W);
}

// f(x) = g.x has the world gradient g; along the lattice's axes per metre its components are R^T g.
TEST(Lattice, TurnsAGradientAlongItsAxesIntoTheWorld) {
  const Lattice lattice = oblique();
  const Vec3 g_W(1, -4, 2);
  Vec3 along;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step_W = lattice.toWorld(Vec3::Unit(axis)) - lattice.toWorld(Vec3::Zero());
    along[axis] = g_W.dot(step_W) / lattice.spacing_m[axis];
  }
  EXPECT_LT((lattice.gradientToWorld(along) - g_W).norm(), 1e-12);
}

TEST(Lattice, ShiftedNamesAnotherSampleZero) {
  const Lattice lattice = oblique();
  const Vec3i first(5, 6, 7);
  EXPECT_LT((lattice.shifted(first).toWorld({1, 2, 3}) - lattice.toWorld({6, 8, 10})).norm(), 1e-15);
}

// A turn by 90 degrees about z takes i to y and j to -x; k is reversed.
TEST(Lattice, WorldBoxHoldsTheTurnedCorners) {
  Lattice lattice;
  lattice.origin_W = {0.1, 0.2, 0.3};
  lattice.R_WL << 0, -1, 0, 1, 0, 0, 0, 0, -1;
  lattice.spacing_m = {1e-3, 2e-3, 3e-3};
  const WorldBox box = worldBoxOf(lattice, {11, 21, 31});
  EXPECT_LT((box.low_W - Vec3(0.1 - 0.04, 0.2, 0.3 - 0.09)).norm(), 1e-15);
  EXPECT_LT((box.high_W - Vec3(0.1, 0.2 + 0.01, 0.3)).norm(), 1e-15);
  const WorldBox point = worldBoxOf(oblique(), Vec3i::Ones());
  EXPECT_EQ(point.low_W, oblique().origin_W);
  EXPECT_EQ(point.high_W, oblique().origin_W);
}

TEST(Lattice, AcceptsWhatIsUsable) {
  EXPECT_NO_THROW(checkLattice(oblique(), "scan"));
}

TEST(Lattice, RefusesBadSpacing) {
  for (const double bad :
       {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Lattice lattice = oblique();
    lattice.spacing_m.y() = bad;
    EXPECT_THROW(checkLattice(lattice, "scan"), Error) << bad;
  }
}

TEST(Lattice, NamesABadSpacingInMillimetres) {
  Lattice lattice = oblique();
  lattice.spacing_m = {0.5e-3, -0.25e-3, 2e-3};
  EXPECT_EQ(refusalOf([&] { checkLattice(lattice, "scan"); }),
            "scan: spacing 0.5 x -0.25 x 2 mm is not positive; write the true voxel size into the file's header");
}

TEST(Lattice, RefusesAnOriginThatIsNoPlace) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Lattice lattice = oblique();
    lattice.origin_W.z() = bad;
    EXPECT_THROW(checkLattice(lattice, "scan"), Error) << bad;
  }
}

// Two axes whose cosine is off by a little less and a little more than the tolerance of 1e-4.
TEST(Lattice, AxesMayBeOffByATenthOfAThousandth) {
  const auto sheared = [](double by) {
    Lattice lattice = oblique();
    lattice.R_WL.col(0) = (lattice.R_WL.col(0) + by * lattice.R_WL.col(1)).normalized();
    return lattice;
  };
  EXPECT_NO_THROW(checkLattice(sheared(0.9e-4), "scan"));
  EXPECT_THROW(checkLattice(sheared(1.1e-4), "scan"), Error);
}

TEST(Lattice, RefusesShearedAxes) {
  Lattice lattice = oblique();
  lattice.R_WL.col(0) = (lattice.R_WL.col(0) + 0.01 * lattice.R_WL.col(1)).normalized();
  EXPECT_THROW(checkLattice(lattice, "scan"), Error);
}

TEST(Lattice, AcceptsTheRoundingOfSixDigitDirections) {
  Lattice lattice = oblique();
  lattice.R_WL = (lattice.R_WL * 1e6).array().round() / 1e6;
  EXPECT_NO_THROW(checkLattice(lattice, "scan"));
}

}  // namespace lattice_test
}  // namespace palpate
