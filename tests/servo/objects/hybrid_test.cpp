// SPDX-License-Identifier: Apache-2.0
// A volume and objects together, through the algorithms; and the god-object, which is objects alone.
//
// The bone is a ball of 20 mm in voxels of h = 1 mm. Interpolation along an edge moves its surface by at most h^2 / 8
// of each second derivative, of which two are 1 / R: 12.5 um.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"
#include "support/algorithm_driver.hpp"
#include "support/test_meshes.hpp"

namespace palpate {
namespace hybrid_test {

constexpr double kRadius_m = 20e-3;
constexpr double kFieldError_m = 12.5e-6;
constexpr double kOff_m = ObjectContacts::kStandOff_m;
const Vec3 kCentre_W = Vec3::Constant(31.3e-3);

AnalyticVolume bone() {
  return millimetreVolume(ball(kCentre_W, kRadius_m));
}

std::unique_ptr<Algorithm> make(std::string_view name, ContactObjects objects, int n = 1) {
  AlgorithmSetup setup;
  setup.parameters.plane_renewal_ticks = n;
  setup.parameters.damping_Ns_per_m = 0;
  setup.objects = std::move(objects);
  return makeAlgorithm(name, std::move(setup));
}

// A floor through the ball, 12 mm above its centre: they meet in a circle of 16 mm.
constexpr double kFloor_m = 12e-3;
constexpr double kGroove_m = 16e-3;
ContactObjects floorObject() {
  return {std::make_shared<const PlaneObject>(kCentre_W + Vec3(0, 0, kFloor_m), Vec3::UnitZ())};
}
// The same floor as a mesh: a plate around the bone, which goes through it.
ContactObjects floorMesh() {
  return {std::make_shared<const MeshObject>(boxMesh(kCentre_W + Vec3(0, 0, kFloor_m - 5e-3), {60e-3, 60e-3, 10e-3}))};
}
Vec3 inGroove(double angle, double radius_m, double height_m) {
  return kCentre_W + Vec3(radius_m * std::cos(angle), radius_m * std::sin(angle), kFloor_m + height_m);
}

void expectSame(const TickOutput& a, const TickOutput& b, int tick) {
  EXPECT_EQ(a.vhip_W, b.vhip_W) << tick;
  EXPECT_EQ(a.force_W, b.force_W) << tick;
  EXPECT_EQ(a.normal_W, b.normal_W) << tick;
  EXPECT_EQ(a.in_contact, b.in_contact) << tick;
  EXPECT_EQ(a.plane_age_ticks, b.plane_age_ticks) << tick;
  EXPECT_EQ(a.faults, b.faults) << tick;
}

class EachVolumeAlgorithm : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Hybrid, EachVolumeAlgorithm, testing::Values("hri", "hri-paper"));

// Objects that the tool does not meet change no bit: one far away, one inside the bone under the tool's whole way.
TEST_P(EachVolumeAlgorithm, ObjectsThatAreNotMetChangeNothing) {
  const AnalyticVolume volume = bone();
  const auto alone = make(GetParam(), {}, 5);
  const auto hybrid = make(GetParam(),
                           {std::make_shared<const SphereObject>(Vec3(0, 0, 0.2), 5e-3),
                            std::make_shared<const SphereObject>(kCentre_W, kRadius_m - 0.3e-3),
                            std::make_shared<const MeshObject>(sphereMesh(kCentre_W, kRadius_m - 0.2e-3, 3))},
                           5);
  const Vec3 start_W = kCentre_W + Vec3(0, 0, kRadius_m + 2e-3);
  AlgorithmDriver a(*alone, volume, start_W), b(*hybrid, volume, start_W);
  int touching = 0;
  for (const Vec3& to :
       {Vec3(0, 0, kRadius_m - 1e-3), Vec3(8e-3, 2e-3, kRadius_m - 3.5e-3), Vec3(8e-3, 2e-3, kRadius_m)}) {
    const auto of_a = a.stroke(kCentre_W + to, 200);
    const auto of_b = b.stroke(kCentre_W + to, 200);
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      expectSame(of_a[i], of_b[i], static_cast<int>(i));
      touching += of_a[i].in_contact ? 1 : 0;
    }
  }
  EXPECT_GT(touching, 300);
}

// Where the bone is taken away the object in it holds the tool.
TEST(Hybrid, AnObjectInTheBoneIsTouchedWhenTheBoneIsGone) {
  const AnalyticVolume volume = bone();
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -1.0; });
  const auto algorithm = make("hri", {std::make_shared<const SphereObject>(kCentre_W, kRadius_m - 1e-3)});
  AlgorithmDriver driver(*algorithm, volume, kCentre_W + Vec3(0, 0, kRadius_m + 1e-3));
  const Vec3 hip_W = kCentre_W + Vec3(0, 0, kRadius_m - 2e-3);
  const TickOutput on_bone = driver.stroke(hip_W, 20).back();
  EXPECT_NEAR((on_bone.vhip_W - kCentre_W).norm(), kRadius_m, kFieldError_m);
  driver.edit(nothing);
  const TickOutput on_object = driver.stroke(hip_W, 3).back();
  ASSERT_TRUE(on_object.in_contact);
  EXPECT_NEAR((on_object.vhip_W - kCentre_W).norm(), kRadius_m - 1e-3, 2 * kOff_m);
}

// In the groove between bone and floor the VHIP is where both surfaces are. The bone's error moves it along the floor
// by 1 / 0.8 of it (the ball's normal there is (0.8, 0.6)); the plane that HRI puts through its nearest point follows
// the VHIP; 2 um for stand-offs, and as much as a kUsable step of the search may leave (0.02 voxel / 0.8).
TEST(Hybrid, InTheGrooveBetweenBoneAndFloor) {
  const AnalyticVolume volume = bone();
  for (const ContactObjects& floor : {floorObject(), floorMesh()}) {
    const auto algorithm = make("hri", floor);
    AlgorithmDriver driver(*algorithm, volume, inGroove(0, 20e-3, 2e-3));
    driver.stroke(inGroove(0, 17e-3, -0.5e-3), 100);
    driver.stroke(inGroove(0, 15.5e-3, -0.5e-3), 100);
    for (double angle = 0; angle < 6.2; angle += 0.002) {
      const TickOutput out = driver.at(inGroove(angle, 15.5e-3, -0.5e-3));
      ASSERT_EQ(out.faults, 0U);
      ASSERT_TRUE(out.in_contact);
      const Vec3 truth_W = inGroove(angle, kGroove_m, 0);
      ASSERT_LE((out.vhip_W - truth_W).norm(), (kFieldError_m + 20e-6) / 0.8 + 2 * kOff_m) << angle;
      ASSERT_LE((out.force_W - 500 * (out.vhip_W - inGroove(angle, 15.5e-3, -0.5e-3))).norm(), 1e-12);
    }
  }
}

// A tool wedged between a plate and the bone, slowly pressed, moved around, and held: the force changes by no more than
//   K step ((1 + n k) / s + ...):
// 1 for what the HIP moves, n k for a plane n ticks old on a ball, which turns with the tool (k = d / (R - d), d the
// depth behind it) and on a field whose error changes by at most pi / h of itself per metre (0.04); 1 / s, s the sine
// of the angle between plate and bone (0.8), for what a motion of one plane does to their common line; and once a
// stand-off.
TEST(Hybrid, AToolWedgedBetweenMeshAndBoneDoesNotJitter) {
  const AnalyticVolume volume = bone();
  for (const int n : {1, 5}) {
    for (const ContactObjects& floor : {floorObject(), floorMesh()}) {
      for (const double step_m : {2e-6, 10e-6, 50e-6}) {
        SCOPED_TRACE(testing::Message() << "n " << n << ", step " << step_m);
        const auto algorithm = make("hri", floor, n);
        AlgorithmDriver driver(*algorithm, volume, inGroove(0, 18e-3, 1e-3));
        Vec3 from_W = inGroove(0, 18e-3, 0.2e-3);
        driver.stroke(from_W, 50);
        TickOutput last = driver.at(from_W);
        const Vec3 way[] = {inGroove(0, 16.5e-3, -0.5e-3), inGroove(0, 15e-3, -1e-3),
                            inGroove(0.02, 15e-3, -1e-3),  inGroove(0.02, 15.8e-3, -0.1e-3),
                            inGroove(0, 15.8e-3, -1e-3),   inGroove(0, 15.2e-3, 0.1e-3)};
        constexpr double kDepth_m = 2e-3;  // behind the ball, at most
        const double k = kDepth_m / (kRadius_m - kDepth_m) + 0.04;
        int both = 0;
        for (const Vec3& to_W : way) {
          const int ticks = static_cast<int>(std::ceil((to_W - from_W).norm() / step_m));
          const double moved_m = (to_W - from_W).norm() / ticks;
          const double bound_N = 500 * (moved_m * (1 + n * k) / 0.8 + 2 * kOff_m / 0.8);
          for (int i = 1; i <= ticks; ++i) {
            const Vec3 hip_W = from_W + (to_W - from_W) * (static_cast<double>(i) / ticks);
            const TickOutput out = driver.at(hip_W);
            ASSERT_LE((out.force_W - last.force_W).norm(), bound_N)
                << "tick " << i << " to " << (to_W - kCentre_W).transpose();
            const bool on_floor = std::abs(out.vhip_W.z() - kCentre_W.z() - kFloor_m) < 2 * kOff_m;
            const bool on_bone = std::abs((out.vhip_W - kCentre_W).norm() - kRadius_m) < 2 * kFieldError_m;
            both += on_floor && on_bone ? 1 : 0;
            last = out;
          }
          from_W = to_W;
        }
        EXPECT_GT(both, 0.004 / step_m / 4) << "it is meant to be wedged";
        // Held still: a renewed plane is off by d / R of what the last one was, so after ten of them, and when what an
        // object's leaving left has been taken in (EditLead: 500 ticks), nothing moves.
        const Vec3 held_W = inGroove(0.01, 15e-3, -0.7e-3);
        driver.stroke(held_W, 100);
        for (int i = 0; i < 500 + 10 * n; ++i) last = driver.at(held_W);
        for (int i = 0; i < 200; ++i) {
          const TickOutput out = driver.at(held_W);
          ASSERT_LE((out.force_W - last.force_W).norm(), 500 * 1e-9) << i;
          last = out;
        }
      }
    }
  }
}

class RecordingEffect final : public ContactEffect {
 public:
  explicit RecordingEffect(ContactState& last, int& releases) : last_(last), releases_(releases) {}
  void release() noexcept override { ++releases_; }
  void move(const ContactState& contact, ContactPush& push) noexcept override {
    last_ = contact;
    push.vhip_W += Vec3(1e-3, 0, 0);
  }

 private:
  ContactState& last_;
  int& releases_;
};

TEST(Hybrid, EffectsGetThePlaneThroughTheCombinedVhip) {
  AlgorithmSetup setup;
  ContactState last;
  int releases = 0;
  setup.effects.push_back(std::make_unique<RecordingEffect>(last, releases));
  setup.objects = {std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3::UnitZ()),
                   std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3::UnitX())};
  setup.parameters.damping_Ns_per_m = 0;
  const auto algorithm = makeAlgorithm("hri", std::move(setup));
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -1.0; });
  AlgorithmDriver driver(*algorithm, nothing, Vec3::Constant(2e-3));
  const Vec3 hip_W(-3e-3, 2e-3, -4e-3);
  const TickOutput out = driver.at(hip_W);
  EXPECT_TRUE(last.new_contact);
  EXPECT_LE((last.plane.p_W - Vec3(0, 2e-3, 0)).norm(), 2 * kOff_m);
  EXPECT_LE((last.plane.normal_W - Vec3(0.6, 0, 0.8)).norm(), 1e-3);
  EXPECT_NEAR(last.plane.depth(hip_W), 5e-3, 2 * kOff_m);
  EXPECT_LE((out.vhip_W - Vec3(1e-3, 2e-3, 0)).norm(), 2 * kOff_m) << "moved by the effect";
  EXPECT_LE((out.force_W - 500 * (out.vhip_W - hip_W)).norm(), 1e-12);
  (void)driver.at(hip_W);
  EXPECT_FALSE(last.new_contact) << "the effect's push is not where the tool is held";
  const int before = releases;
  (void)driver.at(Vec3::Constant(2e-3));
  EXPECT_EQ(releases, before + 1);
}

// In a corner of two objects the VHIP stays where it is while the HIP moves along: no switch of planes, so nothing for
// recovery to take up. What it took up before, it gives back without pushing the hand along its own way.
TEST(Hybrid, RecoveryInACornerOfObjectsTakesUpNothing) {
  for (const bool with_recovery : {false, true}) {
    AlgorithmSetup setup;
    setup.parameters.damping_Ns_per_m = 0;
    setup.effects = makeContactEffects({.recovery_s = with_recovery ? 0.02 : 0.0}, 500, 1000);
    setup.objects = {std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3::UnitZ()),
                     std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3::UnitX())};
    const auto algorithm = makeAlgorithm("hri", std::move(setup));
    const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -1.0; });
    AlgorithmDriver driver(*algorithm, nothing, Vec3::Constant(2e-3));
    for (const TickOutput& out : driver.stroke(Vec3(-8e-3, 2e-3, -4e-3), 40)) static_cast<void>(out);
    for (const TickOutput& out : driver.stroke(Vec3(-1e-3, 2e-3, -4e-3), 70)) {  // 0.1 m/s
      ASSERT_TRUE(out.in_contact);
      EXPECT_GE(out.vhip_W.x(), 0);
      EXPECT_GE(out.vhip_W.z(), 0);
      EXPECT_LE((out.vhip_W - Vec3(0, 2e-3, 0)).norm(), 3 * kOff_m);
    }
  }
}

// What of an effect reads the volume says nothing of a plate beside it.
TEST(Hybrid, EffectsThatReadTheVolumeLeaveObjectsAlone) {
  EffectParameters effects;
  effects.force_shading = true;
  effects.texture = TextureKind::kDensity;
  effects.stiffness_by_density = {{-1e-3, 0.5}, {1e-3, 3}};
  const AnalyticVolume volume = bone();
  for (const bool with_effects : {false, true}) {
    AlgorithmSetup setup;
    setup.parameters.damping_Ns_per_m = 0;
    if (with_effects) setup.effects = makeContactEffects(effects, 500, 1000);
    setup.objects = floorObject();
    const auto algorithm = makeAlgorithm("hri", std::move(setup));
    AlgorithmDriver driver(*algorithm, volume, inGroove(0.3, kGroove_m + 1e-3, 2e-3));
    driver.at(inGroove(0.3, kGroove_m + 1e-3, 2e-3));
    for (const TickOutput& out : driver.stroke(inGroove(0.5, kGroove_m + 2e-3, -1e-3), 30)) {
      if (!out.in_contact) continue;
      EXPECT_LE(out.force_W.cross(Vec3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(out.vhip_W.z(), kCentre_W.z() + kFloor_m, 2 * kOff_m);
    }
  }
}

// ---- the god-object ----

std::unique_ptr<Algorithm> godObject(TriangleMesh mesh) {
  AlgorithmSetup setup;
  setup.isosurface = std::make_shared<const MeshObject>(std::move(mesh));
  setup.parameters.damping_Ns_per_m = 0;
  return makeAlgorithm("god-object", std::move(setup));
}

// On facets at most h wide of a ball: the sagitta h^2 / 6 R, and a force that leans by at most the facet's circumradius
// over R, and as much again until the next slide.
TEST(GodObject, OnAMeshOfABall) {
  const TriangleMesh mesh = sphereMesh(kCentre_W, kRadius_m, 4);
  const double h_m = longestEdge(mesh);
  const double sagitta_m = 1.01 * h_m * h_m / (6 * kRadius_m);
  const double lean = 2.02 * h_m / (std::sqrt(3.0) * kRadius_m);
  const auto algorithm = godObject(mesh);
  const AnalyticVolume volume = bone();
  AlgorithmDriver driver(*algorithm, volume, kCentre_W + Vec3(0, 0, kRadius_m + 1e-3));
  driver.follow = false;
  for (double angle = 0; angle < 6; angle += 0.005) {
    const Vec3 direction(std::sin(angle) * std::cos(0.7 * angle), std::sin(angle) * std::sin(0.7 * angle),
                         std::cos(angle));
    const TickOutput out = driver.at(kCentre_W + (kRadius_m - 1e-3) * direction);
    ASSERT_TRUE(out.in_contact);
    ASSERT_NEAR((out.vhip_W - kCentre_W).norm(), kRadius_m, sagitta_m + 2 * kOff_m) << angle;
    ASSERT_GT(out.force_W.normalized().dot(direction), std::cos(lean)) << angle;
  }
}

// No fall-through in 100,000 ticks over facets, edges and vertices, at 0.1 to 2 m/s, on a knobbly field: a ball whose
// radius varies, so that the mesh has pits.
TEST(GodObject, DoesNotFallThrough) {
  TriangleMesh mesh = sphereMesh(Vec3::Zero(), 1, 5);
  const auto knobbly = [](const Vec3& u) {
    return kRadius_m * (1 + 0.08 * std::sin(9 * u.x()) * std::sin(8 * u.y()) * std::cos(7 * u.z()));
  };
  for (Vec3& vertex : mesh.vertices_W) vertex = kCentre_W + knobbly(vertex) * vertex;
  const auto algorithm = godObject(mesh);
  const AnalyticVolume volume = bone();
  AlgorithmDriver driver(*algorithm, volume, kCentre_W + Vec3(0, 0, 1.2 * kRadius_m));
  driver.follow = false;
  double angle = 0;
  for (int tick = 0; tick < 100000; ++tick) {
    angle += 5e-3 + 45e-3 * (1 + std::sin(1e-3 * tick));  // 0.1 to 1.9 m/s on 20 mm
    const Vec3 direction =
        Vec3(std::cos(angle), std::sin(angle) * std::cos(0.013 * angle), std::sin(0.37 * angle)).normalized();
    const TickOutput out = driver.at(kCentre_W + 0.85 * kRadius_m * direction);
    ASSERT_TRUE(out.in_contact) << tick;
    // Above the lowest pit less a facet's sagitta, which 1 % of R covers.
    ASSERT_GT((out.vhip_W - kCentre_W).norm(), 0.91 * kRadius_m) << tick;
  }
}

TEST(GodObject, TakesFurtherObjects) {
  AlgorithmSetup setup;
  setup.isosurface = std::make_shared<const MeshObject>(boxMesh(Vec3::Zero(), Vec3::Constant(20e-3)));
  setup.objects = {std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3::UnitX())};
  setup.parameters.damping_Ns_per_m = 0;
  const auto algorithm = makeAlgorithm("god-object", std::move(setup));
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -1.0; });
  AlgorithmDriver driver(*algorithm, nothing, {1e-3, 0, 12e-3});
  driver.follow = false;
  const TickOutput out = driver.stroke({-1e-3, 0, 9e-3}, 10).back();
  EXPECT_LE((out.vhip_W - Vec3(0, 0, 10e-3)).norm(), 2 * kOff_m);
}

TEST(GodObject, NeedsAMesh) {
  EXPECT_TRUE(algorithmEntry("god-object").needs.isosurface_mesh);
  EXPECT_FALSE(algorithmEntry("hri").needs.isosurface_mesh);
  try {
    (void)makeAlgorithm("god-object", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "algorithm god-object: the isosurface's mesh is missing; extract it from the volume first");
  }
  EXPECT_THROW((void)MeshObject(TriangleMesh{}), Error);
}

}  // namespace hybrid_test
}  // namespace palpate
