// SPDX-License-Identifier: Apache-2.0
// What edits do, against formulas. The kernels equal this twin bit for bit (tests/engine/service/editor_test.cpp), so
// what holds here holds for them.
//
// Where a surface lies: densities are linear in the distance over every cell that the surface crosses, so the only
// error of the trilinear isosurface is the sag of a curved distance: at most h^2/8 times the second derivative along
// each axis, which is at most 1/rho at distance rho from the centre or axis; the cells reach one diagonal further in. A
// distance is convex, so what is interpolated is never less than it: the surface lies at the radius or within the sag
// inside it. Floats at 0.05 m are off by some 1e-9 m.
#include "engine/reference/edit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/field/mesh_distance.hpp"
#include "engine/reference/isosurface.hpp"

namespace palpate {
namespace edit_test {

using reference::DenseField;

constexpr double kIsovalue = 30;
const Vec3i kSize(48, 40, 32);

Lattice lattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  return lattice;
}
BrushProfile profile() {
  return brushProfile(kIsovalue, -100, 200, lattice().spacing_m);
}

template <typename Density>
DenseField field(const Density& density) {
  DenseField made{kSize, lattice(), {}};
  for (int k = 0; k < kSize.z(); ++k) {
    for (int j = 0; j < kSize.y(); ++j) {
      for (int i = 0; i < kSize.x(); ++i) made.values.push_back(static_cast<float>(density(i, j, k)));
    }
  }
  return made;
}
DenseField constant(double density) {
  return field([=](int, int, int) { return density; });
}

Vec3 at(double i, double j, double k) {
  return lattice().toWorld({i, j, k});
}
const Vec3 kMiddle(23.3, 19.6, 15.8);  // [voxel], between voxels

EditCommand brush(EditKind kind, double radius_m) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = at(kMiddle.x(), kMiddle.y(), kMiddle.z());
  command.radius_m = radius_m;
  return command;
}

void apply(DenseField& f, const EditCommand& command) {
  reference::applyEdits(f, lowerEdits(std::span(&command, 1), kSize, lattice(), profile()));
}

// Where the density passes the isovalue on the way from `from_W` along a unit direction [m]; by bisection to 1e-10 m.
double crossing(const DenseField& f, const Vec3& from_W, const Vec3& direction_W, double most_m) {
  const auto above = [&](double t) {
    return reference::trilinear(f, f.lattice.toIndex(from_W + t * direction_W)) > kIsovalue;
  };
  double low = 0;
  double high = most_m;
  EXPECT_NE(above(low), above(high));
  while (high - low > 1e-10) {
    const double middle = (low + high) / 2;
    (above(middle) == above(0) ? low : high) = middle;
  }
  return low;
}

std::vector<Vec3> directions() {
  std::vector<Vec3> list;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (x != 0 || y != 0 || z != 0) list.push_back(Vec3(x, y, z).normalized());
      }
    }
  }
  return list;
}

void expectSurfaceAt(double distance_m, double radius_m) {
  constexpr double kFloats = 1e-8;
  const Vec3 h = lattice().spacing_m;
  EXPECT_LE(distance_m, radius_m + kFloats);
  EXPECT_GE(distance_m, radius_m - h.squaredNorm() / 8 / (radius_m - h.norm()) - kFloats);
}

constexpr double kRadius = 8e-3;

class Sphere : public testing::TestWithParam<bool> {};

TEST_P(Sphere, LiesAtTheRadius) {
  const bool adds = GetParam();
  DenseField f = constant(adds ? -100 : 200);
  apply(f, brush(adds ? EditKind::kAdd : EditKind::kRemove, kRadius));
  const Vec3 centre = at(kMiddle.x(), kMiddle.y(), kMiddle.z());
  for (const Vec3& direction : directions()) expectSurfaceAt(crossing(f, centre, direction, 1.4 * kRadius), kRadius);
}

// Also where what is filled is hardly denser than the isovalue.
TEST(Add, LiesAtTheRadiusWhateverIsFilledIn) {
  const Vec3 centre = at(kMiddle.x(), kMiddle.y(), kMiddle.z());
  for (const double object : {kIsovalue + 0.5, kIsovalue + 20, 3000.0}) {
    DenseField f = constant(-100);
    EditCommand command = brush(EditKind::kAdd, kRadius);
    command.object = object;
    apply(f, command);
    for (const Vec3& direction : directions()) expectSurfaceAt(crossing(f, centre, direction, 1.4 * kRadius), kRadius);
    const double middle =
        kIsovalue + slopeTowards(profile(), object) *
                        (kRadius - (Vec3(23, 20, 16) - kMiddle).cwiseProduct(lattice().spacing_m).norm());
    EXPECT_NEAR(f.at(23, 20, 16), std::min(object, middle), 1e-3);
  }
}

// Around a stroke from a to b the same holds for the distance from the segment: all along it, so without gaps.
TEST_P(Sphere, SweepsACapsuleWithoutGaps) {
  const bool adds = GetParam();
  const double radius = 5e-3;
  DenseField f = constant(adds ? -100 : 200);
  EditCommand command = brush(adds ? EditKind::kAdd : EditKind::kRemove, radius);
  command.from_W = at(11, 14, 12);
  command.to_W = at(36, 25, 19);
  apply(f, command);
  const Vec3 along = (command.to_W - command.from_W).normalized();
  const Vec3 side = along.unitOrthogonal();
  const double length = (command.to_W - command.from_W).norm();
  for (double t = 0; t <= length; t += 0.9e-3) {
    for (double angle = 0; angle < 6; angle += 0.7) {
      const Vec3 direction = Eigen::AngleAxisd(angle, along) * side;
      expectSurfaceAt(crossing(f, command.from_W + t * along, direction, 1.5 * radius), radius);
    }
  }
  expectSurfaceAt(crossing(f, command.to_W, along, 1.5 * radius), radius);
}

// Once more changes nothing, and what is out of reach never changed.
TEST_P(Sphere, IsDoneOnce) {
  const double outside = GetParam() ? -100 : 200;
  DenseField f = constant(outside);
  const EditCommand command = brush(GetParam() ? EditKind::kAdd : EditKind::kRemove, kRadius);
  apply(f, command);
  const std::vector<float> once = f.values;
  apply(f, command);
  EXPECT_EQ(f.values, once);
  int untouched = 0;
  for (int k = 0; k < kSize.z(); ++k) {
    for (int j = 0; j < kSize.y(); ++j) {
      for (int i = 0; i < kSize.x(); ++i) {
        const double distance = (Vec3(i, j, k) - kMiddle).cwiseProduct(lattice().spacing_m).norm();
        if (distance <= kRadius + profile().band_m + 1e-6) continue;
        EXPECT_EQ(f.at(i, j, k), static_cast<float>(outside));
        ++untouched;
      }
    }
  }
  EXPECT_GT(untouched, 1000);
}

INSTANTIATE_TEST_SUITE_P(RemovedAndAdded, Sphere, testing::Bool());

// At the centre the target is the background; a step takes its share of the way, less where the material is dense.
TEST(Removal, IsGradedByStrengthAndMaterial) {
  for (const double density : {200.0, 120.0, 40.0}) {
    DenseField f = constant(density);
    EditCommand command = brush(EditKind::kRemove, kRadius);
    command.strength = 0.25;
    command.material = MaterialRate{40, 200, 0.8};
    apply(f, command);
    const double rate = 0.25 * (1 - 0.8 * (density - 40) / 160);
    EXPECT_NEAR(f.at(23, 20, 16), density + rate * (-100 - density), 1e-4);  // floats at 200: some 1e-5
  }
}

// smoothstep((r - d) / (falloff r)): half way through the fade it is one half, at the radius nothing.
TEST(Removal, FadesWithFalloff) {
  DenseField f = constant(200);
  EditCommand command = brush(EditKind::kRemove, kRadius);
  command.from_W = command.to_W = at(23, 20, 16);
  command.falloff = 1;
  apply(f, command);
  EXPECT_EQ(f.at(23, 20, 16), -100);
  const double s = (kRadius - 5 * 0.7e-3) / kRadius;  // five voxels along i
  const double target = std::max(-100.0, kIsovalue - profile().slope_per_m * (kRadius - 5 * 0.7e-3));
  EXPECT_NEAR(f.at(28, 20, 16), 200 + s * s * (3 - 2 * s) * (target - 200), 1e-3);
  EXPECT_EQ(f.at(23 + 12, 20, 16), 200);  // 8.4 mm out
}

// A trilinear field that is linear is exact; densities of 200 are off by 1.5e-5, or 5e-10 m at this slope, and places
// by a few 1e-9 m.
TEST(Cut, LeavesAPlane) {
  DenseField f = constant(200);
  EditCommand command;
  command.kind = EditKind::kCut;
  command.plane_W = at(kMiddle.x(), kMiddle.y(), kMiddle.z());
  command.normal_W = Vec3(1, -2, 0.5);
  apply(f, command);
  const Vec3 out = command.normal_W.normalized();
  for (const Vec3& direction : directions()) {
    const Vec3 aside = 5e-3 * (direction - direction.dot(out) * out);
    EXPECT_NEAR(crossing(f, command.plane_W + aside - 6e-3 * out, out, 12e-3), 6e-3, 2e-8);
  }
  EXPECT_EQ(f.at(40, 2, 16), -100);  // far above the plane all is background
}

TEST(Flatten, LeavesAPlaneInsideTheBrush) {
  DenseField f = field([](int i, int j, int k) { return (i * 7 + j * 5 + k * 3) % 11 < 5 ? 180.0 : -80.0; });
  EditCommand command = brush(EditKind::kFlatten, 12e-3);
  command.plane_W = command.from_W;
  command.normal_W = Vec3(0.3, 0.2, 1);
  apply(f, command);
  const Vec3 out = command.normal_W.normalized();
  for (const Vec3& direction : directions()) {
    const Vec3 aside = 6e-3 * (direction - direction.dot(out) * out);
    EXPECT_NEAR(crossing(f, command.plane_W + aside - 2e-3 * out, out, 4e-3), 2e-3, 2e-8);
  }
}

TEST(Paint, MovesDensitiesTowardsTheValue) {
  DenseField f = constant(-100);
  EditCommand command = brush(EditKind::kPaint, kRadius);
  command.value = 60;
  command.strength = 0.5;
  apply(f, command);
  EXPECT_EQ(f.at(23, 20, 16), -20);  // half way; exact in float
  command.strength = 1;
  apply(f, command);
  EXPECT_EQ(f.at(23, 20, 16), 60);
  EXPECT_EQ(f.at(40, 20, 16), -100);
}

// A plane field that rises along k by 26 a voxel: 20000 density/m. Inflating at full strength moves its isosurface by
// half the smallest spacing, 0.35 mm, against the gradient; deflating back.
TEST(Inflate, MovesTheSurfaceByHalfAVoxel) {
  const auto plane = [](int, int, int k) { return 26.0 * k - 300; };
  for (const bool out : {true, false}) {
    DenseField f = field(plane);
    const Vec3 from = at(23, 20, 9);
    const Vec3 up = lattice().R_WL.col(2);
    const double before = crossing(f, from, up, 9e-3);
    EditCommand command = brush(out ? EditKind::kInflate : EditKind::kDeflate, 10e-3);
    command.from_W = command.to_W = at(23, 20, 13);
    apply(f, command);
    EXPECT_NEAR(crossing(f, from, up, 9e-3) - before, out ? -0.35e-3 : 0.35e-3, 1e-8);
  }
}

TEST(Inflate, MakesNoNewExtremes) {
  DenseField f = field([](int i, int j, int k) { return (i / 3 + j / 2 + k / 2) % 2 == 0 ? 200.0 : -100.0; });
  for (int n = 0; n < 5; ++n) apply(f, brush(EditKind::kInflate, kRadius));
  for (const float value : f.values) {
    EXPECT_LE(value, 200);
    EXPECT_GE(value, -100);
  }
}

// One voxel of 60 in nothing: its neighbours get (h_min / h)^2 / 6 of it each, and the sum stays.
TEST(Smooth, SpreadsByTheSpacing) {
  DenseField f = field([](int i, int j, int k) { return i == 23 && j == 20 && k == 16 ? 60.0 : 0.0; });
  apply(f, brush(EditKind::kSmooth, kRadius));
  const Vec3 share = (0.7e-3 / lattice().spacing_m.array()).square() / 6;
  EXPECT_NEAR(f.at(24, 20, 16), 60 * share.x(), 1e-5);
  EXPECT_NEAR(f.at(23, 19, 16), 60 * share.y(), 1e-5);
  EXPECT_NEAR(f.at(23, 20, 17), 60 * share.z(), 1e-5);
  EXPECT_NEAR(f.at(23, 20, 16), 60 * (1 - 2 * share.sum()), 1e-5);
}

TEST(Smooth, LeavesALinearFieldAlone) {
  const auto plane = [](int i, int j, int k) { return 2.0 * i - 3.0 * j + 5.0 * k; };  // small integers: exact
  DenseField f = field(plane);
  const DenseField before = f;
  apply(f, brush(EditKind::kSmooth, 6e-3));
  EXPECT_EQ(f.values, before.values);
}

// A mesh of a box, 6 x 7 x 8 mm, turned: its faces lie where they were, by a voxel of the stamp (0.25 mm) away from
// edges, in planes that trilinear interpolation keeps: floats of distances below 1e-2 m are off by 1e-9 m, and the
// mesh's own corners in float by 4e-8 of 40 voxels.
// Densities anywhere among the floats, of neighbours too: differences, their squares and sums overflow, and axes with
// different signs. No kind of edit may make anything but a number of it, and those that only move densities towards
// their neighbours' none beyond all of these. 1e17 apart on these voxels the square of a slope overflows already.
class Extremes : public testing::TestWithParam<EditKind> {};

TEST_P(Extremes, StayFiniteAndAmongTheirNeighbours) {
  const EditKind kind = GetParam();
  for (const float most : {1e17F, 1e30F, std::numeric_limits<float>::max()}) {
    std::mt19937 random(7);
    const std::array<float, 8> values = {most, -most, most / 2, -most / 3, 1e-40F, 0, -0.0F, 60};
    DenseField f = field([&](int, int, int) { return values[random() % values.size()]; });
    const DenseField first = f;
    for (const double strength : {1.0, 0.3, 1e-40}) {
      for (const double falloff : {0.0, 0.7}) {
        EditCommand command = brush(kind, 5e-3);
        command.strength = strength;
        command.falloff = falloff;
        command.plane_W = command.from_W;
        command.value = 1e30;
        command.material = MaterialRate{-1e30, 1e30, 0.5};
        if (isStamp(kind)) command.stamp = RandomEdits::ball(3e-3);
        const BrushProfile steep = brushProfile(kIsovalue, -most, most, lattice().spacing_m);
        reference::applyEdits(f, lowerEdits(std::span(&command, 1), kSize, lattice(), steep));
        EXPECT_NE(f.values, first.values) << editName(kind);
        ASSERT_TRUE(std::all_of(f.values.begin(), f.values.end(), [](float value) { return std::isfinite(value); }))
            << editName(kind) << " at strength " << strength << ", densities up to " << most;
        if (kind != EditKind::kSmooth && kind != EditKind::kInflate && kind != EditKind::kDeflate) continue;
        // A mean of many may be off by its roundings.
        for (const float value : f.values) ASSERT_LE(std::abs(static_cast<double>(value)), most * (1 + 1e-6));
      }
    }
  }
}
std::vector<EditKind> everyKind() {
  std::vector<EditKind> kinds;
  for (unsigned n = 0; n < kEditKinds; ++n) kinds.push_back(static_cast<EditKind>(n));
  return kinds;
}
INSTANTIATE_TEST_SUITE_P(Kinds, Extremes, testing::ValuesIn(everyKind()));

TEST(Stamp, PutsTheMeshsFaces) {
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c)
    points.emplace_back((c & 1) != 0 ? 3e-3 : -3e-3, (c & 2) != 0 ? 3.5e-3 : -3.5e-3, (c & 4) != 0 ? 4e-3 : -4e-3);
  const std::vector<Vec3i> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const bool adds : {true, false}) {
    EditCommand command = brush(adds ? EditKind::kStampAdd : EditKind::kStampRemove, 0);
    command.stamp =
        std::make_shared<Stamp>(meshDistance(points, triangles, 0.25e-3, profile().band_m, profile().band_m));
    command.R_WS = Eigen::AngleAxisd(0.5, Vec3(1, 1, 0).normalized()).matrix() * lattice().R_WL;
    DenseField f = constant(adds ? -100 : 200);
    apply(f, command);
    const double half[3] = {3e-3, 3.5e-3, 4e-3};
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 direction = sign * command.R_WS.col(axis);
        EXPECT_NEAR(crossing(f, command.from_W, direction, half[axis] + 2e-3), half[axis], 1e-6) << axis;
      }
    }
  }
}

// The ramp goes on to the middle: a body's inside gets what a brush of its depth would give it. Background and object
// lie five times as far from the isovalue as the flatter side, so the ramp is ten voxels deep and more.
TEST(Stamp, FillsAndClearsToItsMiddle) {
  const Vec3 half(6e-3, 6.5e-3, 7e-3);
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c)
    points.emplace_back((c & 1) != 0 ? half.x() : -half.x(), (c & 2) != 0 ? half.y() : -half.y(),
                        (c & 4) != 0 ? half.z() : -half.z());
  const std::vector<Vec3i> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const bool adds : {true, false}) {
    const double near = adds ? kIsovalue - 130 : kIsovalue + 130;
    const double far = adds ? kIsovalue + 650 : kIsovalue - 650;
    const BrushProfile steep = brushProfile(kIsovalue, std::min(near, far), std::max(near, far), lattice().spacing_m);
    const double depth_m = rampDepth(steep, steep.object);
    EXPECT_NEAR(depth_m, 5 * steep.band_m, 1e-12);
    EditCommand command = brush(adds ? EditKind::kStampAdd : EditKind::kStampRemove, 0);
    command.stamp = std::make_shared<Stamp>(meshDistance(points, triangles, 0.25e-3, steep.band_m, depth_m));
    command.R_WS = lattice().R_WL;
    DenseField f = constant(near);
    reference::applyEdits(f, lowerEdits(std::span(&command, 1), kSize, lattice(), steep));
    for (const Vec3i& voxel : {Vec3i(23, 20, 16), Vec3i(22, 19, 15), Vec3i(25, 20, 16), Vec3i(23, 22, 16)}) {
      const Vec3 away = (voxel.cast<double>() - kMiddle).cwiseProduct(lattice().spacing_m).cwiseAbs();
      const double depth = (half - away).minCoeff();
      ASSERT_GT(depth, 1.3 * steep.band_m);
      // Trilinear samples of a distance that bends where two faces are as near: off by a voxel's diagonal of the stamp.
      const double off = 0.25e-3 * std::sqrt(3) * steep.slope_per_m;
      EXPECT_NEAR(f.at(voxel.x(), voxel.y(), voxel.z()), kIsovalue + (adds ? 1 : -1) * steep.slope_per_m * depth, off);
    }
  }
}

TEST(MeshDistance, RefusesWhatIsNoMesh) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW((void)meshDistance(points, {}, 0.1, 0.2, 0.2), Error);
  EXPECT_THROW((void)meshDistance(points, {{0, 1, 3}}, 0.1, 0.2, 0.2), Error);
  EXPECT_THROW((void)meshDistance(points, {{0, 1, 2}}, 0, 0.2, 0.2), Error);
  EXPECT_THROW((void)meshDistance(points, {{0, 1, 2}}, 1e-4, 0.2, 0.2), Error);
  EXPECT_THROW((void)meshDistance({{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}}, {{0, 1, 2}}, 0.1, 0.2, 0.2), Error);
  EXPECT_THROW((void)meshDistance(points, {{0, 1, 2}}, 0.1, 0.2, 0), Error);
}

}  // namespace edit_test
}  // namespace palpate
