// SPDX-License-Identifier: Apache-2.0
// Shapes that no scanner promises to avoid: flat, thin, sharp, rough.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/extreme/ground.hpp"

namespace palpate {
namespace shape_cases {
namespace {

using DensityAt = std::function<double(double height_voxel, const Vec3& p_W)>;

constexpr const char* kSafe = "no force beyond the limits, no VHIP that is not finite";
constexpr const char* kHeld = "the tool is held and pushed out";

// The plane is where the density crosses the isovalue, `shift_voxel` above the ground's.
void addPlane(ExtremeCases& to, const std::string& name, const std::string& expectation, double isovalue,
              double shift_voxel, double depth_voxel, const DensityAt& density) {
  to.push_back({"shapes", name, expectation, [=] {
                  const Ground ground;
                  Ground shifted;
                  shifted.plane.p_W = shift_voxel * ground.voxel_m() * Vec3::UnitZ();
                  const RoughRun run = pressOn(sampledFrom(ground, isovalue, density), shifted, depth_voxel);
                  return Judge(run, play(run))
                      .feels(shifted.plane, placeError_m(shifted, depth_voxel))
                      .raisesNoFadingFault()
                      .outcome();
                }});
}

void addHeld(ExtremeCases& to, const std::string& name, double isovalue, double depth_voxel, const DensityAt& density) {
  to.push_back({"shapes", name, kHeld, [=] {
                  const Ground ground;
                  const RoughRun run = pressOn(sampledFrom(ground, isovalue, density), ground, depth_voxel, 5);
                  constexpr double kLeast_N = 0.05;  // a hand feels that
                  return Judge(run, play(run)).isPushed(Vec3::UnitZ(), kLeast_N).raisesNoFadingFault().outcome();
                }});
}

void addSafe(ExtremeCases& to, const std::string& name, double isovalue, double depth_voxel, const DensityAt& density) {
  to.push_back({"shapes", name, kSafe, [=] {
                  const Ground ground;
                  const RoughRun run = pressOn(sampledFrom(ground, isovalue, density), ground, depth_voxel, 5);
                  return Judge(run, play(run)).outcome();
                }});
}

double radius_voxel(const Vec3& p_W) {
  return std::hypot(p_W.x(), p_W.y()) / 1e-3;
}

// The voxel's own index, since a lattice point may lie on either side of a border by rounding.
Vec3i voxelOf(const Vec3& p_W) {
  return Ground{}.lattice().toIndex(p_W).array().round().cast<int>();
}

// A step from 0 to 1 with noise that depends on the voxel alone.
DensityAt noisy(double amplitude) {
  return [=](double height, const Vec3& p_W) {
    const Vec3i at = voxelOf(p_W);
    Random random(static_cast<std::uint64_t>(at.x() + 64 * (at.y() + 64 * at.z())));
    return (height < 0 ? 1.0 : 0.0) + amplitude * random.uniform(-1, 1);
  };
}

}  // namespace
}  // namespace shape_cases

void addShapeCases(ExtremeCases& to) {
  using namespace shape_cases;
  const char* felt = "the plane is felt where the density crosses the isovalue";
  // Steps lie half a voxel from the next voxel centres on both sides: the ground's plane is 0.4 voxel above a layer.
  const double layer = Ground{}.lattice().toIndex(Vec3::Zero()).z();
  const double middle = std::floor(layer) + 0.5 - layer;
  addPlane(to, "a step from 0 to 1 within a voxel", felt, 0.5, middle, 1.5,
           [](double height, const Vec3&) { return height < 0 ? 1.0 : 0.0; });
  addPlane(to, "a step, pressed 5 voxels into where every gradient is zero", felt, 0.5, middle, 5,
           [](double height, const Vec3&) { return height < 0 ? 1.0 : 0.0; });
  addPlane(to, "a step of 1e30", felt, 0.5e30, middle, 1.5,
           [](double height, const Vec3&) { return height < 0 ? 1e30 : 0.0; });
  // Flat at the isovalue for 3 voxels: background, as long as it is not above.
  addPlane(
      to, "a plateau exactly at the isovalue in front of the object", "the plane is felt at the plateau's lower end", 0,
      std::floor(layer) - 3 - layer, 1.5, [=](double height, const Vec3&) {
        const double steps = std::round(height + layer - std::floor(layer));  // layers above the one below the plane
        return steps >= -3 ? std::min(0.0, -steps) : -3 - steps;
      });
  addHeld(to, "a shell of one voxel, pressed 0.4 voxel", 0.5, 0.4,
          [=](double height, const Vec3&) { return std::round(height + layer - std::floor(layer)) == 0 ? 1.0 : 0.0; });
  addHeld(to, "a shell of one voxel, pressed 5 voxels", 0.5, 5,
          [=](double height, const Vec3&) { return std::round(height + layer - std::floor(layer)) == 0 ? 1.0 : 0.0; });
  const Vec3i tip = voxelOf(Vec3::Zero());
  addSafe(to, "a needle of one voxel, met off its axis", 0.5, 3, [=](double, const Vec3& p_W) {
    const Vec3i at = voxelOf(p_W);
    return at.x() == tip.x() && at.y() == tip.y() && at.z() <= tip.z() ? 1.0 : 0.0;
  });
  addSafe(to, "an object of one voxel", 0.5, 0.5,
          [=](double, const Vec3& p_W) { return voxelOf(p_W) == tip ? 1.0 : 0.0; });
  addHeld(to, "a cusp: the tip of a cone", 0, 2,
          [](double height, const Vec3& p_W) { return -(height + 2 * radius_voxel(p_W)) + 1; });
  addHeld(to, "a groove: the inside of a cone", 0, 2,
          [](double height, const Vec3& p_W) { return -(height - 2 * radius_voxel(p_W)); });
  addHeld(to, "an edge of 90 degrees", 0, 2,
          [](double height, const Vec3& p_W) { return -(height + std::abs(p_W.x()) / 1e-3); });
  addSafe(to, "a checkerboard of 1 and -1: every central difference is zero", 0, 3,
          [](double, const Vec3& p_W) { return voxelOf(p_W).sum() % 2 == 0 ? 1.0 : -1.0; });
  addSafe(to, "noise as large as the signal", 0.5, 3, noisy(1));
  addSafe(to, "noise ten times as large as the signal", 0.5, 3, noisy(10));
  addSafe(to, "a voxel of 1e30 under the surface", 0, 3,
          [=](double height, const Vec3& p_W) { return voxelOf(p_W) == tip - Vec3i(0, 0, 2) ? 1e30 : -height; });
  addSafe(to, "a voxel of -1e30 under the surface", 0, 3,
          [=](double height, const Vec3& p_W) { return voxelOf(p_W) == tip - Vec3i(0, 0, 2) ? -1e30 : -height; });
}

}  // namespace palpate
