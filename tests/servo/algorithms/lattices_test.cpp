// SPDX-License-Identifier: Apache-2.0
// Every algorithm of the registry on voxels that are not cubes, on turned and on left-handed lattices.
//
// Slides over a plane, a ball and a hollow, as deep as the smallest side of a voxel and a twentieth of that a tick,
// planes renewed every tick. What is allowed is what sampling at three spacings does to the field (sampledBound) and
// what the algorithm does to that.
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/algorithm_setups.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace lattices_test {

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

  Scene(Kind of_kind, const Vec3& spacing_m, Seeded& random, bool left_handed)
      : kind(of_kind), radius_m(6 * spacing_m.maxCoeff()), u(random.direction()), v(random.across(u)) {
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

constexpr double kStep = 0.05;  // a tick, of the depth [-]

struct Slide {
  std::vector<Vec3> hips_W;
  std::vector<TickOutput> outs;
};
// Every place twice: the second tick is at rest, where haptization has no viscosity.
Slide slideOver(const Scene& scene, const AnalyticVolume& volume, std::string_view name) {
  const auto algorithm = makeFor(name, parameters(), volume, 4 * scene.depth_m);
  AlgorithmDriver driver(*algorithm, volume, scene.at(0, -scene.depth_m));
  driver.around_vhip = true;
  driver.at(scene.at(0, -scene.depth_m));
  driver.stroke(scene.at(0, scene.depth_m), 40);
  Slide slide;
  for (int i = 0; i < 300; ++i) {
    slide.hips_W.push_back(scene.at(std::min(i * kStep * scene.depth_m, 0.5 * scene.radius_m), scene.depth_m));
    driver.at(slide.hips_W.back());
    slide.outs.push_back(driver.at(slide.hips_W.back()));
  }
  return slide;
}

// How far the VHIP may be from the surface, and the force from the normal.
SampledBound boundOf(std::string_view name, const Scene& scene) {
  SampledBound bound = scene.bound;
  const double curvature = scene.kind == Scene::kPlane ? 0 : 1 / scene.radius_m;
  if (algorithmEntry(name).needs.isosurface_mesh) {
    // Its surface is that of tetrahedra in which the density is linear (isosurface_mesh.hpp), L across. In a ball of
    // radius sqrt(3/8) L around each that errs by half the radius squared times f''. Each has an edge along every axis
    // of the lattice, so each part of its gradient is the true one somewhere within L: off by L f'', three of them.
    const double L = scene.volume.lattice.spacing_m.norm();
    bound.radians = std::numbers::sqrt3 * L * curvature + 2e-6;
    bound.metres =
        3.0 / 16 * L * L * curvature / (1 - bound.radians) + ObjectContacts::kStandOff_m + 2e-5 * scene.depth_m;
  }
  // Density over steepness: off by as much of the depth as the steepness is.
  if (name == "avila") bound.metres += bound.radians * scene.depth_m;
  bound.radians *= scene.leverage();
  // At most four ticks behind (hri-paper, accuracy_test.cpp), and the tolerance of a search, a fiftieth of a voxel.
  const double behind_m = (4 * kStep + 0.02) * scene.depth_m;
  bound.radians += behind_m * curvature;
  bound.metres += 0.5 * behind_m * behind_m * curvature;
  return bound;
}

class Lattices : public testing::TestWithParam<std::tuple<std::string, Voxel>> {
 protected:
  [[nodiscard]] std::string name() const { return std::get<0>(GetParam()); }
  [[nodiscard]] Vec3 spacing_m() const { return std::get<1>(GetParam()).spacing_m; }
};

TEST_P(Lattices, VhipAndForceAreAsTrueAsTheSamplesAre) {
  Seeded random(31);
  for (int trial = 0; trial < 12; ++trial) {
    const Scene scene(static_cast<Scene::Kind>(trial % 3), spacing_m(), random, trial % 2 == 1);
    SCOPED_TRACE(testing::Message() << "trial " << trial << " kind " << scene.kind);
    const Slide slide = slideOver(scene, scene.volume, name());
    const SampledBound bound = boundOf(name(), scene);
    // Haptization's table rises to 3 N at half of the contrast of 4 depths; it has no VHIP.
    const bool has_vhip = name() != "haptization";
    const double stiffness = has_vhip ? kStiffness : 1.5 / scene.depth_m;
    double metres = 0, radians = 0, off_m = 0;
    for (std::size_t i = 5; i < slide.outs.size(); ++i) {
      const TickOutput& out = slide.outs[i];
      ASSERT_TRUE(out.in_contact) << i << " " << faultNames(out.faults);
      ASSERT_EQ(out.faults, 0U) << i << " " << faultNames(out.faults);
      if (has_vhip) metres = std::max(metres, std::abs(scene.surface.distance_m(out.vhip_W)));
      radians = std::max(radians, angleBetween(out.force_W, scene.surface.normal(slide.hips_W[i])));
      off_m = std::max(off_m, std::abs(out.force_W.norm() / stiffness - scene.depth_m));
    }
    EXPECT_LE(metres, bound.metres);
    EXPECT_LE(radians, bound.radians);
    // Along a line that is off by t the way to the surface is longer by 1 / cos t.
    EXPECT_LE(off_m, bound.metres + bound.radians * bound.radians * scene.depth_m);
  }
}

// The same samples in the same places, numbered from the other end of an axis or with two axes exchanged: the lattice
// is left-handed where it was right-handed. The trace is the same, but for roundings (properties_test.cpp).
AnalyticVolume otherHanded(const AnalyticVolume& volume, int way) {
  AnalyticVolume other = volume;
  other.samples = nullptr;  // found by their places
  if (way < 3) {
    other.lattice.origin_W = volume.lattice.toWorld((volume.size[way] - 1) * Vec3::Unit(way));
    other.lattice.R_WL.col(way) *= -1;
  } else {
    const int a = way - 3;
    const int b = (a + 1) % 3;
    other.lattice.R_WL.col(a).swap(other.lattice.R_WL.col(b));
    std::swap(other.lattice.spacing_m[a], other.lattice.spacing_m[b]);
    std::swap(other.size[a], other.size[b]);
  }
  return other;
}

// Not the god-object: another lattice has other diagonals, so other triangles, which are held to their bound above.
class FieldLattices : public Lattices {};

TEST_P(FieldLattices, HandsAreFeltAlike) {
  constexpr double kPart = 1e-4;  // of a voxel's smallest side, of a unit normal
  Seeded random(32);
  for (int trial = 0; trial < 12; ++trial) {
    const Scene scene(static_cast<Scene::Kind>(trial % 3), spacing_m(), random, false);
    const AnalyticVolume other = otherHanded(scene.volume, trial % 6);
    ASSERT_GT(scene.volume.lattice.R_WL.determinant(), 0);
    ASSERT_LT(other.lattice.R_WL.determinant(), 0);
    const Slide right = slideOver(scene, scene.volume, name());
    const Slide left = slideOver(scene, other, name());
    for (std::size_t i = 0; i < right.outs.size(); ++i) {
      const TickOutput& a = right.outs[i];
      const TickOutput& b = left.outs[i];
      ASSERT_EQ(a.in_contact, b.in_contact) << trial << " " << i;
      ASSERT_EQ(a.faults, b.faults) << trial << " " << i;
      ASSERT_LT((a.vhip_W - b.vhip_W).norm(), kPart * scene.depth_m) << trial << " " << i;
      ASSERT_LT((a.normal_W - b.normal_W).norm(), kPart) << trial << " " << i;
      ASSERT_LT((a.force_W - b.force_W).norm(), kPart * (a.force_W.norm() + kStiffness * scene.depth_m))
          << trial << " " << i;
    }
  }
}

// Whatever the lattice, the mesh that the god-object touches faces outward: a corner between triangles' normals and the
// surface's is below a right angle. (Too small a triangle has no normal to speak of.)
TEST(LatticeMesh, FacesOutwardOnLatticesOfBothHands) {
  Seeded random(33);
  for (int trial = 0; trial < 12; ++trial) {
    const Scene scene(trial % 2 == 0 ? Scene::kBall : Scene::kHollow, kVoxels[trial % 3].spacing_m, random,
                      trial % 4 < 2);
    const AlgorithmSetup setup = setupFor("god-object", parameters(), scene.volume, 4 * scene.depth_m);
    const auto& object = dynamic_cast<const MeshObject&>(*setup.isosurface);
    EXPECT_TRUE(object.solid());
    const TriangleMesh& mesh = object.mesh();
    int faces = 0;
    for (const auto& triangle : mesh.triangles) {
      const Vec3& a = mesh.vertices_W[triangle[0]];
      const Vec3 b = mesh.vertices_W[triangle[1]] - a;
      const Vec3 c = mesh.vertices_W[triangle[2]] - a;
      const double smallest_m = scene.volume.lattice.smallestSpacing();
      if (b.cross(c).norm() < 0.01 * smallest_m * smallest_m) continue;
      // A hollow's object ends with the volume, too.
      if (std::abs(scene.surface.distance_m(a + (b + c) / 3)) > 0.5 * smallest_m) continue;
      ASSERT_GT(b.cross(c).dot(scene.surface.normal(a)), 0) << trial;
      ++faces;
    }
    EXPECT_GT(faces, 1000);
  }
}

std::string word(const testing::TestParamInfo<std::tuple<std::string, Voxel>>& test) {
  std::string text = std::get<0>(test.param) + std::string("On") + std::get<1>(test.param).name;
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}
std::vector<std::string> names(bool with_meshes) {
  std::vector<std::string> all;
  for (const AlgorithmEntry& entry : algorithms()) {
    if (with_meshes || !entry.needs.isosurface_mesh) all.emplace_back(entry.name);
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Each, Lattices, testing::Combine(testing::ValuesIn(names(true)), testing::ValuesIn(kVoxels)),
                         word);
INSTANTIATE_TEST_SUITE_P(Each, FieldLattices,
                         testing::Combine(testing::ValuesIn(names(false)), testing::ValuesIn(kVoxels)), word);

}  // namespace lattices_test
}  // namespace palpate
