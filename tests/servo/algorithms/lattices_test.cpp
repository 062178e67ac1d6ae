// SPDX-License-Identifier: Apache-2.0
// Every algorithm of the registry on voxels that are not cubes, on turned and on left-handed lattices.
//
// Slides over a plane, a ball and a hollow, 1 smallest voxel deep and slow, planes renewed every tick. What is allowed
// is what sampling at three spacings does to the field (sampledBound) and what the algorithm does to that.
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/objects/mesh_object.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/algorithm_setups.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace {

constexpr double kStiffness = 500;  // [N/m]

struct Voxel {
  const char* name;
  Vec3 spacing_m;
};
const Voxel kVoxels[] = {
    {"Slices", {0.5e-3, 0.5e-3, 3e-3}}, {"ThickSlices", {1e-3, 1e-3, 5e-3}}, {"Bricks", {0.3e-3, 2e-3, 0.7e-3}}};

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A surface on a lattice, and a way along it.
struct Scene {
  enum Kind { kPlane, kBall, kHollow };

  Scene(Kind kind_, const Vec3& spacing_m, Seeded& random, bool left_handed)
      : kind(kind_), radius_m(6 * spacing_m.maxCoeff()), u(random.direction()), v(random.across(u)) {
    const AnalyticSurface solid = ballSurface(Vec3::Zero(), radius_m);
    surface = kind == kPlane ? planeSurface(u * radius_m, u) : kind == kBall ? solid : hollow(solid);
    Sampling sampling{.flat_m = 4 * spacing_m.maxCoeff()};
    // Room for the ball, the outside of a hollow, and a margin.
    const Vec3 half_m = Vec3::Constant(radius_m + 3 * spacing_m.maxCoeff());
    sampling.size = (2 * half_m.cwiseQuotient(spacing_m)).array().ceil().cast<int>() + 2;
    sampling.lattice =
        latticeAround(Vec3::Zero(), sampling.size, spacing_m, random.axes(left_handed), random.inCube(0.5));
    volume = stored(sampledOn(sampling, surface));
    depth_m = volume.lattice.smallestSpacing();
    bound = SampledBound{2e-5 * depth_m, 2e-6};  // floats (accuracy_test.cpp)
    // Gradients read two layers below the surface point's cell at most.
    if (kind != kPlane) bound = sampledBound(radius_m - 2 * spacing_m.maxCoeff(), spacing_m);
  }
  [[nodiscard]] Vec3 at(double way_m, double below_m) const {
    if (kind == kPlane) return u * (radius_m - below_m) + v * (way_m - 0.25 * radius_m);
    const double angle = way_m / radius_m;
    return (u * std::cos(angle) + v * std::sin(angle)) * (radius_m + (kind == kBall ? -below_m : below_m));
  }
  // The radius that the HIP has left to the middle, as a share of the surface's: what turns an error of a normal into
  // one of the point whose normal line meets the HIP.
  [[nodiscard]] double leverage() const {
    return kind == kPlane ? 1 : radius_m / (kind == kBall ? radius_m - depth_m : radius_m + depth_m);
  }

  Kind kind;
  double radius_m;
  Vec3 u, v;
  AnalyticSurface surface;
  AnalyticVolume volume;
  double depth_m = 0;
  SampledBound bound{0, 0};
};

AlgorithmParameters parameters() {
  return {.isovalue = 0, .stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = 1};
}

std::vector<TickOutput> slide(const Scene& scene, std::string_view name, std::vector<Vec3>& hips_W) {
  const auto algorithm = makeFor(name, parameters(), scene.volume, 4 * scene.depth_m);
  AlgorithmDriver driver(*algorithm, scene.volume, scene.at(0, -scene.depth_m));
  driver.around_vhip = true;
  driver.at(scene.at(0, -scene.depth_m));
  driver.stroke(scene.at(0, scene.depth_m), 40);
  std::vector<TickOutput> outs;
  const double step_m = 0.05 * scene.depth_m;
  for (int i = 0; i < 400; ++i) {
    const double way_m = std::min(i * step_m, 0.5 * scene.radius_m);
    hips_W.push_back(scene.at(way_m, scene.depth_m));
    outs.push_back(driver.at(hips_W.back()));
  }
  return outs;
}

class Lattices : public testing::TestWithParam<std::tuple<std::string, Voxel>> {
 protected:
  [[nodiscard]] std::string name() const { return std::get<0>(GetParam()); }
  [[nodiscard]] Vec3 spacing_m() const { return std::get<1>(GetParam()).spacing_m; }
  [[nodiscard]] bool onMesh() const { return algorithmEntry(name()).needs.isosurface_mesh; }
};

TEST_P(Lattices, VhipAndForceAreAsTrueAsTheSamplesAre) {
  Seeded random(31);
  for (int trial = 0; trial < 12; ++trial) {
    const Scene scene(static_cast<Scene::Kind>(trial % 3), spacing_m(), random, trial % 2 == 1);
    SCOPED_TRACE(testing::Message() << "trial " << trial << " kind " << scene.kind);
    std::vector<Vec3> hips_W;
    const auto outs = slide(scene, name(), hips_W);
    double metres = 0, radians = 0, newtons = 0;
    for (std::size_t i = 10; i < outs.size(); ++i) {
      const TickOutput& out = outs[i];
      ASSERT_TRUE(out.in_contact) << i << " " << faultNames(out.faults);
      ASSERT_EQ(out.faults, 0U) << i << " " << faultNames(out.faults);
      metres = std::max(metres, std::abs(scene.surface.distance_m(out.vhip_W)));
      radians = std::max(radians, angleBetween(out.force_W, scene.surface.normal(hips_W[i])));
      newtons = std::max(newtons, std::abs(out.force_W.norm() / kStiffness - scene.depth_m));
    }
    if (getenv("SHOW"))
      printf("%s %s trial %d kind %d: m %.4f of %.4f  rad %.4f of %.4f depth %.4f voxel\n", name().c_str(),
             std::get<1>(GetParam()).name, trial, scene.kind, metres / scene.depth_m,
             scene.bound.metres / scene.depth_m, radians, scene.bound.radians * scene.leverage(),
             newtons / scene.depth_m);
  }
}

std::string word(const testing::TestParamInfo<std::tuple<std::string, Voxel>>& test) {
  std::string text = std::get<0>(test.param) + std::string("On") + std::get<1>(test.param).name;
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}
std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const AlgorithmEntry& entry : algorithms()) all.emplace_back(entry.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Each, Lattices, testing::Combine(testing::ValuesIn(names()), testing::ValuesIn(kVoxels)),
                         word);

}  // namespace
}  // namespace palpate
