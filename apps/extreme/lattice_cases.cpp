// SPDX-License-Identifier: Apache-2.0
// Voxels of any size and shape, anywhere in the world.
#include <fmt/format.h>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace lattice_cases {
namespace {

constexpr const char* kFelt = "the plane is felt as anywhere else";

// Any turn that has no zero in it.
Mat3 someTurn() {
  return Eigen::AngleAxisd(0.7, Vec3(0.36, 0.48, 0.8)).toRotationMatrix();
}

Vec3 someNormal() {
  return Vec3(0.2, -0.5, 0.9).normalized();
}

void add(ExtremeCases& to, const std::string& name, const Ground& ground) {
  to.push_back({"lattice", name, kFelt, [ground] { return feelsGround(ground); }});
}

Ground at(const Vec3& p_W, double spacing_m) {
  Ground ground{.spacing_m = Vec3::Constant(spacing_m)};
  ground.plane = {p_W, someNormal()};
  ground.R_WL = someTurn();
  return ground;
}

// An object that fills the volume is cut off at its outermost voxel centres, and can be felt there.
ExtremeOutcome feelsCutFace(const Vec3& p_W, const Mat3& R_WL) {
  Ground ground{.R_WL = R_WL, .plane = {p_W, Vec3::UnitZ()}};
  const SampledVolumePtr volume = sampledFrom(ground, 0, [](double, const Vec3&) { return 1.0; });
  const Vec3 face_L((ground.size.x() - 1) / 2.0, (ground.size.y() - 1) / 2.0, ground.size.z() - 1);
  Ground face = ground;
  face.plane = {volume->lattice().toWorld(face_L), volume->lattice().R_WL.col(2)};
  const RoughRun run = pressOn(volume, face);
  return Judge(run, play(run)).feels(face.plane, placeError_m(face)).raisesNoFadingFault().outcome();
}

ExtremeOutcome latticeIsRefused(const Vec3& origin_W, double spacing_m, const char* words) {
  Lattice lattice;
  lattice.origin_W = origin_W;
  lattice.spacing_m = Vec3::Constant(spacing_m);
  return refusedWith(words, [&] { checkLattice(lattice, "an extreme case"); });
}

}  // namespace
}  // namespace lattice_cases

void addLatticeCases(ExtremeCases& to) {
  using namespace lattice_cases;
  add(to, "voxels of 1 nm", at(Vec3::Zero(), 1e-9));
  add(to, "voxels of 1 um", at(Vec3::Zero(), 1e-6));
  add(to, "voxels of 10 m", at(Vec3::Zero(), 10));
  for (int axis = 0; axis < 3; ++axis) {
    Ground ground;
    ground.spacing_m = Vec3::Constant(0.1e-3);
    ground.spacing_m[axis] = 10e-3;
    add(to, fmt::format("anisotropy of 1:100 along axis {}", axis), ground);
    ground.plane.normal_W = Vec3::Unit(axis);
    add(to, fmt::format("anisotropy of 1:100 along axis {}, touched along it", axis), ground);
  }
  add(to, "world offset of 1e3 m, turned", at(Vec3(1e3, -1e3, 1e3), 1e-3));
  add(to, "world offset of 1e6 m, turned", at(Vec3(-1e6, 1e6, 1e6), 1e-3));
  add(to, "world offset of 1e6 m, voxels of 10 um", at(Vec3(1e6, 0, 0), 1e-5));
  {
    Ground ground = at(Vec3(1, 2, 3), 1e-3);
    ground.R_WL.col(2) *= -1;
    add(to, "left-handed axes", ground);
  }
  const char* face = "the cut face is felt";
  to.push_back({"lattice", "a full volume", face, [] { return feelsCutFace(Vec3::Zero(), Mat3::Identity()); }});
  to.push_back({"lattice", "a full volume at 1e6 m, turned", face,
                [] { return feelsCutFace(Vec3(1e6, 1e6, -1e6), someTurn()); }});
  const char* refused = "refused with what is allowed";
  to.push_back({"lattice", "voxels of 1 nm at 1e6 m", refused,
                [] { return latticeIsRefused(Vec3(1e6, 0, 0), 1e-9, "far from the origin"); }});
  to.push_back(
      {"lattice", "voxels of 1e-30 m", refused, [] { return latticeIsRefused(Vec3::Zero(), 1e-30, "spacing"); }});
  to.push_back(
      {"lattice", "voxels of 1e30 m", refused, [] { return latticeIsRefused(Vec3::Zero(), 1e30, "spacing"); }});
  to.push_back({"lattice", "an origin that is infinite", refused,
                [] { return latticeIsRefused(Vec3(std::numeric_limits<double>::infinity(), 0, 0), 1e-3, "origin"); }});
  to.push_back({"lattice", "a volume of one voxel", "refused when it is to be touched: no cell, no surface", [] {
                  return refusedWith("a surface needs two along every axis", [] {
                    checkTouchable(
                        volumeOfDensity(Vec3i::Ones(), Lattice{}, "one voxel", [](const Vec3&) { return 1.0; }));
                  });
                }});
  to.push_back({"lattice", "a volume of 2 x 2 x 2 voxels", kFelt, [] {
                  Ground ground{.size = Vec3i::Constant(2)};
                  const SampledVolumePtr volume = ground.sampled();
                  const RoughRun run = pressOn(volume, ground, 0.3);
                  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground, 0.3)).outcome();
                }});
}

}  // namespace palpate
