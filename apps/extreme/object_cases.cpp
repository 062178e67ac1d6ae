// SPDX-License-Identifier: Apache-2.0
// Objects beside the volume, and no volume at all.
#include <cmath>

#include <fmt/format.h>

#include "apps/extreme/ground.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"

namespace palpate {
namespace object_cases {
namespace {

// Nothing above the isovalue: the objects are alone.
SampledVolumePtr emptyVolume() {
  return sampledFrom(Ground{}, 0, [](double, const Vec3&) { return -1.0; });
}

RoughRun among(const ContactObjects& objects, const SampledVolumePtr& volume) {
  const Ground ground;
  RoughRun run = pressOn(volume, ground);
  run.objects = objects;
  return run;
}

template <class Shape, class... Arguments>
std::shared_ptr<const ContactObject> make(Arguments&&... arguments) {
  return std::make_shared<const Shape>(std::forward<Arguments>(arguments)...);
}

// The stand-off of objects and the volume's own error.
double allowed_m() {
  return placeError_m(Ground{}) + 2 * ObjectContacts::kStandOff_m;
}

ExtremeOutcome feelsPlane(const ContactObjects& objects, const SampledVolumePtr& volume) {
  const RoughRun run = among(objects, volume);
  return Judge(run, play(run)).feels(ExactPlane{}, allowed_m()).raisesNoFadingFault().outcome();
}

ExtremeOutcome feelsNothingOf(const ContactObjects& objects) {
  const RoughRun run = among(objects, emptyVolume());
  return Judge(run, play(run)).feelsNothing().raisesNoFadingFault().outcome();
}

// Three planes that meet in a point under the tool, at angles to the vertical. By symmetry the force is vertical. The
// VHIP is their common point, unless rounding keeps it from one of them; its height is exact.
ExtremeOutcome wedgeOfThree(double steepness) {
  ContactObjects objects;
  for (int i = 0; i < 3; ++i) {
    const double turn = 2 * std::numbers::pi * i / 3;
    objects.push_back(make<PlaneObject>(Vec3::Zero(), Vec3(std::cos(turn), std::sin(turn), steepness).normalized()));
  }
  const RoughRun run = among(objects, emptyVolume());
  const double tilt = std::hypot(1.0, steepness) / steepness;  // how much higher a stand-off lifts the common point
  Judge judge(run, play(run));
  return judge.feels(ExactPlane{}, tilt * 4 * ObjectContacts::kStandOff_m + placeError_m(Ground{}))
      .raisesNoFadingFault()
      .outcome();
}

TriangleMesh triangle(double side_m) {
  TriangleMesh mesh;
  for (int i = 0; i < 3; ++i) {
    const double turn = 2 * std::numbers::pi * i / 3;
    mesh.vertices_W.emplace_back(side_m * std::cos(turn), side_m * std::sin(turn), 0);
  }
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

}  // namespace
}  // namespace object_cases

void addObjectCases(ExtremeCases& to) {
  using namespace object_cases;
  const auto add = [&](const char* name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"objects", name, expectation, std::move(run)});
  };
  const char* felt = "the plane is felt";
  const char* nothing = "nothing is felt";
  const char* safe = "no force beyond the limits, no VHIP that is not finite";
  add("an empty volume, no objects", nothing, [] { return feelsNothingOf({}); });
  add("a plane in an empty volume", felt,
      [] { return feelsPlane({make<PlaneObject>(Vec3::Zero(), Vec3::UnitZ())}, emptyVolume()); });
  add("a plane where the volume's surface is", felt,
      [] { return feelsPlane({make<PlaneObject>(Vec3::Zero(), Vec3::UnitZ())}, Ground{}.sampled()); });
  add("the same plane six times", felt,
      [] { return feelsPlane(ContactObjects(6, make<PlaneObject>(Vec3::Zero(), Vec3::UnitZ())), emptyVolume()); });
  add("a ball of 1000 km", felt, [] { return feelsPlane({make<SphereObject>(Vec3(0, 0, -1e6), 1e6)}, emptyVolume()); });
  add("a ball of 1 nm in the way", safe, [] {
    const RoughRun run = among({make<SphereObject>(Vec3::Zero(), 1e-9)}, emptyVolume());
    return Judge(run, play(run)).outcome();
  });
  add("a box of 1 nm in the way", safe, [] {
    const RoughRun run = among({make<BoxObject>(Vec3::Zero(), Vec3::Constant(1e-9))}, emptyVolume());
    return Judge(run, play(run)).outcome();
  });
  add("a ball 1e9 m away", nothing, [] { return feelsNothingOf({make<SphereObject>(Vec3(1e9, 0, 0), 1)}); });
  add("a wedge of three planes", "the force points out of the wedge, with the depth of its point",
      [] { return wedgeOfThree(1); });
  add("a narrow wedge of three planes, 5 degrees off the vertical",
      "the force points out of the wedge, with the depth of its point",
      [] { return wedgeOfThree(std::tan(5 * std::numbers::pi / 180)); });
  add("a flat wedge of three planes, 0.01 degrees off the horizontal",
      "the force points out of the wedge, with the depth of its point",
      [] { return wedgeOfThree(1 / std::tan(0.01 * std::numbers::pi / 180)); });
  add("a wedge of the volume, a box and a ball", safe, [] {
    RoughRun run = among(
        {make<BoxObject>(Vec3(3e-3, 0, 0), Vec3(4e-3, 9e-3, 9e-3)), make<SphereObject>(Vec3(-2e-3, 0, 1e-3), 2e-3)},
        Ground{}.sampled());
    return Judge(run, play(run)).isPushed(Vec3::UnitZ(), 0.1).outcome();
  });
  add("a mesh of one triangle of 10 mm", felt,
      [] { return feelsPlane({make<MeshObject>(triangle(10e-3))}, emptyVolume()); });
  add("a mesh of one triangle of 1 um", safe, [] {
    const RoughRun run = among({make<MeshObject>(triangle(1e-6))}, emptyVolume());
    return Judge(run, play(run)).outcome();
  });
  add("a mesh of one triangle without area", "refused, or nothing wild is felt", [] {
    TriangleMesh mesh = triangle(1e-2);
    mesh.vertices_W[2] = mesh.vertices_W[1];
    return refusedWith("triangle", [&] { (void)feelsPlane({make<MeshObject>(mesh)}, emptyVolume()); });
  });
}

}  // namespace palpate
