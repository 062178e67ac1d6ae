// SPDX-License-Identifier: Apache-2.0
// The signed distance: bits against the twin, and the exact distance of simple solids.
#include <cmath>

#include "engine/reference/distance.hpp"
#include "filtered_fields.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace filter_distance_test {

using reference::DenseField;

struct Case {
  std::string chain;
  Vec3i size;
  float isovalue = 0;
};
class DistanceBits : public testing::TestWithParam<Case> {};

TEST_P(DistanceBits, EqualTheTwin) {
  const auto& [chain, size, isovalue] = GetParam();
  const auto steps = lowerFilters(filterChain(chain), testLattice().spacing_m, isovalue);
  for (const Volume& volume : {ballField(size, 9.0), extremes(size)}) {
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps)),
              0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Chains, DistanceBits,
                         testing::Values(Case{"distance:4", {41, 33, 37}}, Case{"distance:6", {40, 48, 24}, 0.7F},
                                         Case{"distance:1", {30, 29, 28}}, Case{"distance:3", {2, 20, 9}, -1},
                                         Case{"distance:5", {2, 2, 17}}, Case{"distance:3", {1, 19, 18}},
                                         Case{"distance:3", {17, 9, 1}}, Case{"distance:2", {2, 2, 2}},
                                         Case{"gaussian:1 distance:3 gaussian:0.7", {33, 20, 26}, 0.5F},
                                         Case{"distance:4 distance:2", {33, 30, 26}, 1.0F}));

// Densities of a solid by its signed distance, positive inside [m], on voxels of a given spacing around the origin.
template <typename Density>
Volume solid(const Vec3i& size, const Vec3& spacing_m, Density density) {
  std::vector<float> values;
  const Vec3 middle = (size.cast<double>().array() - 1) / 2 + 0.137;  // no symmetry with the voxels
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3 voxel = Vec3i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y()).cast<double>();
    values.push_back(static_cast<float>(density(Vec3((voxel - middle).cwiseProduct(spacing_m)))));
  }
  Lattice lattice;
  lattice.spacing_m = spacing_m;
  return Volume::fromDense(size, lattice, values, {});
}

// Largest difference from a solid's own distance, cut off at the band, over voxels chosen by place [m].
struct Worst {
  double error_m = 0;
  Vec3 at_m = Vec3::Zero();
};
template <typename Distance, typename Chosen>
Worst worstError(const DenseField& field, const Vec3& spacing_m, double band_m, Distance distance, Chosen chosen) {
  const Vec3 middle = (field.size.cast<double>().array() - 1) / 2 + 0.137;
  Worst worst;
  for (int n = 0; n < field.size.prod(); ++n) {
    const Vec3i voxel(n % field.size.x(), n / field.size.x() % field.size.y(), n / field.size.x() / field.size.y());
    const Vec3 x = (voxel.cast<double>() - middle).cwiseProduct(spacing_m);
    if (!chosen(x)) continue;
    const double truth = std::clamp(distance(x), -band_m, band_m);
    const double error = std::abs(field.values[static_cast<std::size_t>(n)] - truth);
    if (error > worst.error_m) worst = {error, x};
  }
  return worst;
}

DenseField distanceOnGpu(const Volume& volume, int band, float isovalue) {
  return filteredOnGpu(
      volume, lowerFilters(filterChain("distance:" + std::to_string(band)), volume.lattice().spacing_m, isovalue));
}
constexpr auto kEverywhere = [](const Vec3&) { return true; };

double clamped(double distance_m, double band_m) {
  return std::clamp(distance_m, -band_m, band_m);
}

// A linear density is the same in every interpolation, so the plane is found wherever the surface point lies. Values
// are rounded by u = 2^-24 of at most F, the density at the domain's far corner; a slope is the difference of two of
// them over a voxel, and so is the normal off by 2 u F / (slope h) along each axis, which moves a voxel at most 5
// voxels away by 10 u F / slope an axis; the value at the surface is off by u F, once more by its interpolation (3 u
// F), and all other operations are a dozen roundings of lengths within the band.
TEST(Distance, OfAPlaneIsExact) {
  for (const Vec3& spacing_m : {Vec3(1e-3, 1e-3, 1e-3), Vec3(0.7e-3, 0.9e-3, 2.1e-3)}) {
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(3, -2, 1), Vec3(-1, 4, 5)}) {
      const Vec3 normal = way.normalized();
      const Vec3i size(40, 36, 30);
      const double slope = 5e4;         // [density / m]
      const double offset_m = 0.37e-3;  // of the surface: isovalue / slope
      const Volume volume = solid(size, spacing_m, [&](const Vec3& x) { return slope * normal.dot(x); });
      const double band_m = 4 * spacing_m.minCoeff();
      const auto field = distanceOnGpu(volume, 4, static_cast<float>(slope * offset_m));
      const Vec3 half = (size.cast<double>().array() / 2 - 2.5).matrix().cwiseProduct(spacing_m);
      const auto truth = [&](const Vec3& x) { return normal.dot(x) - offset_m; };
      // Where the nearest surface point and the cells around it lie in the domain.
      const auto chosen = [&](const Vec3& x) {
        return (((x - truth(x) * normal).cwiseAbs() - half).array() <= 0).all();
      };
      const double u = std::ldexp(1, -24);
      const double farthest_m = (size.cast<double>().cwiseProduct(spacing_m) / 2).norm();
      const double bound = u * ((3 * 10 + 4) * farthest_m + 12 * band_m);
      EXPECT_LE(worstError(field, spacing_m, band_m, truth, chosen).error_m, bound) << way.transpose();
    }
  }
}

// A ball: trilinear interpolation lays the surface h^2/8 times the sum of the second derivatives, 2 / R, too far in:
// h^2/(4 R). What else is of second order and smaller: the tangent plane stands for the surface beside the point by the
// angle by which a normal of one cell is off, h / (2 R) along each axis at most.
TEST(Distance, OfABallIsOfSecondOrder) {
  constexpr double kRadius_m = 8e-3;
  const auto ball = [&](const Vec3& x) { return kRadius_m - x.norm(); };
  std::vector<double> errors;
  for (const int finer : {1, 2, 4}) {
    const double h_m = 1e-3 / finer;
    const Vec3 spacing_m = Vec3::Constant(h_m);
    const Volume volume =
        solid(Vec3i::Constant(29 * finer), spacing_m, [&](const Vec3& x) { return 1000 * clamped(ball(x), 2 * h_m); });
    const auto field = distanceOnGpu(volume, 4, 0);
    errors.push_back(worstError(field, spacing_m, 4 * h_m, ball, kEverywhere).error_m);
    EXPECT_LE(errors.back(), 1.1 * h_m * h_m / (4 * kRadius_m));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.1);
}

// A density that is no distance, on voxels that are not cubes: what is interpolated is R^2 - r^2, whose second
// derivatives are -2, so its surface is off by h_x^2 + h_y^2 + h_z^2 over 8 R; the tangent planes' share may be as
// large as that of a ball of 1/h_z voxels: bounded by the same once more. Order 2 between the finer two.
TEST(Distance, OfABallInAnotherDensityAndOtherVoxels) {
  constexpr double kRadius_m = 8e-3;
  std::vector<double> errors;
  for (const int finer : {2, 4}) {
    const Vec3 spacing_m = Vec3(1, 1, 2) * (1e-3 / finer);
    const Volume volume = solid(Vec3i(29, 29, 15) * finer, spacing_m,
                                [&](const Vec3& x) { return kRadius_m * kRadius_m - x.squaredNorm(); });
    const auto field = distanceOnGpu(volume, 4, 0);
    const double band_m = 4 * spacing_m.minCoeff();
    errors.push_back(worstError(
                         field, spacing_m, band_m, [&](const Vec3& x) { return kRadius_m - x.norm(); }, kEverywhere)
                         .error_m);
    EXPECT_LE(errors.back(), 2 * spacing_m.squaredNorm() / (8 * kRadius_m));
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.5);
}

// A torus, whose surface curves both ways, by a density that grows as exp(a d): its second derivatives over its slope
// sum to a + 1/r + 1/(R - r) at most (the last on the ring's inner side), and h^2/8 of that lies between its trilinear
// surface and the torus.
TEST(Distance, OfATorusIsOfSecondOrder) {
  constexpr double kRing_m = 10e-3;
  constexpr double kTube_m = 5e-3;
  constexpr double kSteep_per_m = 200;
  const auto torus = [&](const Vec3& x) { return kTube_m - std::hypot(std::hypot(x.x(), x.y()) - kRing_m, x.z()); };
  std::vector<double> errors;
  for (const int finer : {2, 4}) {
    const Vec3 spacing_m = Vec3::Constant(1e-3 / finer);
    const Volume volume =
        solid(Vec3i(40, 40, 20) * finer, spacing_m, [&](const Vec3& x) { return std::exp(kSteep_per_m * torus(x)); });
    const auto field = distanceOnGpu(volume, 4, 1);
    errors.push_back(worstError(field, spacing_m, 4 * spacing_m.x(), torus, kEverywhere).error_m);
    const double curvature_per_m = kSteep_per_m + 1 / kTube_m + 1 / (kRing_m - kTube_m);
    EXPECT_LE(errors.back(), 1.1 * spacing_m.x() * spacing_m.x() / 8 * curvature_per_m);
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.7);
}

// A box: its faces are planes, exact to the rounding of densities up to 3 voxels, wherever no edge is nearer than the
// band and the ramp's end. At edges and corners, which no trilinear field holds, a voxel may be off by one.
TEST(Distance, OfABoxIsExactOverItsFaces) {
  const double h_m = 0.5e-3;
  const Vec3 half_m(6e-3, 5.3e-3, 7.1e-3);
  const auto box = [&](const Vec3& x) {
    const Vec3 q = x.cwiseAbs() - half_m;
    return -(q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0));
  };
  const Volume volume =
      solid(Vec3i::Constant(44), Vec3::Constant(h_m), [&](const Vec3& x) { return clamped(box(x), 3 * h_m); });
  const auto field = distanceOnGpu(volume, 4, 0);
  const auto faces = [&](const Vec3& x) { return ((x.cwiseAbs() - half_m).cwiseAbs().array() < 6 * h_m).count() <= 1; };
  EXPECT_LE(worstError(field, Vec3::Constant(h_m), 4 * h_m, box, faces).error_m, 64 * std::ldexp(1, -24) * 4 * h_m);
  EXPECT_LE(worstError(field, Vec3::Constant(h_m), 4 * h_m, box, kEverywhere).error_m, h_m);
}

// Above the isovalue is above 0, whatever the densities.
TEST(Distance, IsOnTheDensitysSide) {
  for (const float isovalue : {0.0F, 0.3F}) {
    for (const Volume& volume : {extremes({30, 21, 19}), ballField({41, 33, 37}, 9.0)}) {
      const DenseField before = reference::denseField(volume);
      const DenseField after = distanceOnGpu(volume, 4, isovalue);
      for (std::size_t i = 0; i < after.values.size(); ++i) {
        ASSERT_EQ(after.values[i] > 0, before.values[i] > isovalue) << before.values[i] << " " << after.values[i];
      }
    }
  }
}

// Bricks that the band does not touch have no storage, and hold plus or minus the band: a ball of radius 60 in 160^3
// has some inside and outside. Noise that stays on one side of the isovalue changes nothing.
TEST(Distance, IsConstantFarFromTheSurface) {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  std::mt19937 random(3);
  const Volume volume = makeField({160, 160, 160}, [&](int i, int j, int k) {
    const double inside = 60 - (Vec3(i, j, k) - Vec3::Constant(79.5)).norm();
    return static_cast<float>(std::clamp(inside, -3.0, 3.0) + 1e-6 * static_cast<double>(random() % 1000));
  });
  const BrickPool pool(gpu, transfer, volume);
  const auto steps = lowerFilters(filterChain("distance:4"), Vec3::Constant(1e-3), 0.0F);
  FilterChain chain(gpu, transfer, pool, steps);
  chain.run();
  EXPECT_EQ(pool.storedBricks(), pool.brickCount());
  EXPECT_LT(chain.result().storedBricks(), pool.brickCount() / 2);
  const BrickGrid grid{pool.size(), Vec3::Ones()};
  EXPECT_EQ(chain.result().page(grid.index({0, 0, 0})).constant, -4e-3F);
  EXPECT_EQ(chain.result().page(grid.index({10, 10, 10})).constant, 4e-3F);
  EXPECT_EQ(chain.result().page(grid.index({10, 10, 10})).slot, NO_SLOT);
}

// A change of one density changes distances within the chain's reach of it alone.
TEST(Distance, ReachesAsFarAsItSays) {
  const Lattice lattice = testLattice();
  const auto steps = lowerFilters(filterChain("distance:3"), lattice.spacing_m, 0.0F);
  const Vec3i reach = totalReach(steps);
  EXPECT_EQ(reach, Vec3i(6, 6, 5));  // three voxels of 0.7 mm and of the others' length, and three more
  const Vec3i size(37, 35, 33);
  DenseField before = reference::denseField(extremes(size));
  const DenseField old = reference::applyFilters(before, steps);
  const Vec3i changed(18, 17, 16);
  before.values[before.offset(changed.x(), changed.y(), changed.z())] = 0.5F;
  const DenseField now = reference::applyFilters(before, steps);
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3i voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
    if (((voxel - changed).cwiseAbs().array() <= reach.array()).all()) continue;
    ASSERT_EQ(old.values[static_cast<std::size_t>(n)], now.values[static_cast<std::size_t>(n)]) << voxel.transpose();
  }
}

// The word of the kernel's text. No surface point lies eight voxels away on all three axes, and no voxel lies across
// from itself: these two stand for "none".
TEST(FilterText, KeepsASurfacePointAndAVoxelAcrossInAWord) {
  for (const int x : {-64, -63, -1, 0, 1, 17, 63}) {
    for (const int y : {-64, -5, 0, 17, 63}) {
      for (const int z : {-64, -5, 0, 17, 63}) {
        const std::array<int, 3> point = {x, y, z};
        const std::array<int, 3> across = {x / 9, -y / 9, z / 9};
        for (const bool inside : {false, true}) {
          std::uint32_t across_bits = 0;
          for (int axis = 0; axis < 3; ++axis)
            across_bits |= kernel_text::acrossBits(across[static_cast<std::size_t>(axis)], axis);
          const std::uint32_t word = kernel_text::wordWith(inside, kernel_text::pointBits(x, y, z), across_bits);
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(kernel_text::offsetOf(word, axis), point[static_cast<std::size_t>(axis)]);
            EXPECT_EQ(kernel_text::acrossOf(word, axis), std::abs(across[static_cast<std::size_t>(axis)]));
          }
          EXPECT_EQ(kernel_text::isInside(word), inside);
          EXPECT_EQ(kernel_text::knowsPoint(word), x > -64 || y > -64 || z > -64);
          EXPECT_EQ(kernel_text::knowsAcross(word), across != (std::array<int, 3>{0, 0, 0}));
          EXPECT_TRUE(std::isnormal(std::bit_cast<float>(word)));
        }
      }
    }
  }
}

}  // namespace filter_distance_test
}  // namespace palpate
