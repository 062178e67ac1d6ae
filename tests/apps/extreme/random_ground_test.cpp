// SPDX-License-Identifier: Apache-2.0
// Planes in volumes drawn over the whole range of values, voxels, places and turns, touched by every algorithm that has
// a surface: the exact force must be felt.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/bench/random.hpp"
#include "apps/extreme/ground.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace random_ground_test {

double powerOfTen(Random& random, double low, double high) {
  return std::pow(10, random.uniform(low, high));
}

struct Drawn {
  Ground ground;
  std::string algorithm;
  int n = 1;
};

Drawn draw(Random& random) {
  Drawn drawn;
  Ground& ground = drawn.ground;
  const double voxel_m = powerOfTen(random, -9, 1);
  for (int axis = 0; axis < 3; ++axis) ground.spacing_m[axis] = voxel_m * (axis == 0 ? 1 : powerOfTen(random, 0, 0.7));
  // Gradients must fit a float, as checkTouchable() demands of volumes.
  ground.per_voxel = powerOfTen(random, -40, std::min(34.0, 34 + std::log10(voxel_m)));
  ground.offset = ground.per_voxel * random.uniform(-1, 1) * powerOfTen(random, 0, 4);
  const double far_m = std::min(1e6, 1e9 * voxel_m);
  ground.plane.p_W = far_m * random.uniform() * random.direction();
  ground.plane.normal_W = random.direction();
  ground.R_WL = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
  if (random.uniform() < 0.5) ground.R_WL.col(2) *= -1;
  for (bool shows_surface = false; !shows_surface;) {
    const AlgorithmEntry& entry =
        algorithms()[static_cast<std::size_t>(random.uniform() * static_cast<double>(algorithms().size()))];
    // A mesh is refused if it is large or its triangles are too small (base/triangle_mesh.hpp).
    shows_surface = entry.traits.shows_surface && !entry.needs.isosurface_mesh;
    drawn.algorithm = entry.name;
  }
  drawn.n = static_cast<int>(powerOfTen(random, 0, 2));
  return drawn;
}

TEST(RandomGround, IsFeltWhereItIs) {
  Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const Drawn drawn = draw(random);
    RoughRun run = pressOn(drawn.ground.sampled(), drawn.ground);
    run.algorithm = drawn.algorithm;
    run.parameters.plane_renewal_ticks = drawn.n;
    const ExtremeOutcome outcome =
        Judge(run, play(run)).feels(drawn.ground.plane, placeError_m(drawn.ground)).raisesNoFadingFault().outcome();
    EXPECT_TRUE(outcome.as_expected) << fmt::format(
        "trial {}: {} n={}, {:g} a voxel from {:g}, voxels {:g} {:g} {:g} m, {:g} m away: {}", trial, drawn.algorithm,
        drawn.n, drawn.ground.per_voxel, drawn.ground.offset, drawn.ground.spacing_m.x(), drawn.ground.spacing_m.y(),
        drawn.ground.spacing_m.z(), drawn.ground.plane.p_W.norm(), outcome.seen);
  }
}

}  // namespace random_ground_test
}  // namespace palpate
