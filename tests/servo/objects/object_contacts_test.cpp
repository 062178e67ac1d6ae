// SPDX-License-Identifier: Apache-2.0
// Where objects hold the tool: closed forms, strokes, and forces that do not jitter.
//
// The VHIP is kStandOff_m (1 um) in front of every plane, so a point on k planes that meet at right angles is
// sqrt(k) um from the closed form. Planes are pressed by kPlaneSoftness (1e-10) of the depth: nothing beside it.
#include "servo/objects/object_contacts.hpp"

#include <gtest/gtest.h>

#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"
#include "support/test_meshes.hpp"

namespace palpate {
namespace object_contacts_test {

constexpr double kOff_m = ObjectContacts::kStandOff_m;

template <class... Objects>
ContactObjects listOf(Objects&&... objects) {
  return {std::make_shared<const std::decay_t<Objects>>(std::forward<Objects>(objects))...};
}

// A tool among objects only.
class Tool {
 public:
  Tool(ContactObjects objects, const Vec3& start_W) : contacts_(std::move(objects)), hip_W_(start_W) {
    contacts_.reset(start_W);
  }
  // The VHIP.
  Vec3 at(const Vec3& hip_W) {
    hip_W_ = hip_W;
    (void)contacts_.volumeTool(hip_W, nullptr);
    plane_ = contacts_.settle(hip_W, nullptr);
    return contacts_.vhip_W();
  }
  Vec3 stroke(const Vec3& to_W, int ticks) {
    const Vec3 from_W = hip_W_;
    for (int i = 1; i <= ticks; ++i) at(from_W + (to_W - from_W) * (static_cast<double>(i) / ticks));
    return contacts_.vhip_W();
  }
  // Largest change of VHIP - HIP in a tick over such a stroke, per metre that the HIP moved [-].
  double roughestStroke(const Vec3& to_W, int ticks) {
    const Vec3 from_W = hip_W_;
    Vec3 push_W = contacts_.vhip_W() - hip_W_;
    double roughest = 0;
    for (int i = 1; i <= ticks; ++i) {
      const Vec3 hip_W = from_W + (to_W - from_W) * (static_cast<double>(i) / ticks);
      const Vec3 now_W = at(hip_W) - hip_W;
      roughest = std::max(roughest, (now_W - push_W).norm() / ((to_W - from_W).norm() / ticks));
      push_W = now_W;
    }
    return roughest;
  }
  [[nodiscard]] bool touching() const { return plane_.has_value(); }
  [[nodiscard]] const ContactPlane& plane() const { return *plane_; }

 private:
  ObjectContacts contacts_;
  Vec3 hip_W_;
  std::optional<ContactPlane> plane_;
};

void expectNear(const Vec3& a, const Vec3& b, double tolerance_m) {
  EXPECT_LE((a - b).norm(), tolerance_m) << a.transpose() << " is not " << b.transpose();
}

TEST(ObjectContacts, FreeTheVhipIsTheHip) {
  Tool tool(listOf(PlaneObject(Vec3::Zero(), Vec3::UnitZ())), {0, 0, 1e-3});
  EXPECT_EQ(tool.at({1e-3, 2e-3, 0.5e-3}), Vec3(1e-3, 2e-3, 0.5e-3));
  EXPECT_FALSE(tool.touching());
}

TEST(ObjectContacts, APlaneHoldsItAtTheFoot) {
  Tool tool(listOf(PlaneObject(Vec3::Zero(), Vec3::UnitZ())), {0, 0, 1e-3});
  expectNear(tool.at({1e-3, 2e-3, -3e-3}), {1e-3, 2e-3, 0}, 1.01 * kOff_m);
  ASSERT_TRUE(tool.touching());
  EXPECT_EQ(tool.plane().normal_W, Vec3(Vec3::UnitZ()));
  EXPECT_NEAR(tool.plane().depth({1e-3, 2e-3, -3e-3}), 3e-3, 1.01 * kOff_m);
  EXPECT_EQ(tool.at({1e-3, 2e-3, 3e-3}), Vec3(1e-3, 2e-3, 3e-3)) << "and lets it go";
  EXPECT_FALSE(tool.touching());
}

// The nearest point of a ball of radius R to a HIP at depth d below angle a. A tick ends when its plane turns the goal
// by less than 1 nm, or after four slides of four turns, each of which leaves d / R of the error: here 0.2^16 of 1 mm.
TEST(ObjectContacts, ABallHoldsItAtItsNearestPoint) {
  const double radius_m = 10e-3;
  Tool tool(listOf(SphereObject(Vec3::Zero(), radius_m)), {0, 0, 11e-3});
  for (double angle = 0; angle < 3; angle += 0.01) {
    const Vec3 direction(std::sin(angle), 0, std::cos(angle));
    const Vec3 vhip_W = tool.at(8e-3 * direction);
    ASSERT_LE((vhip_W - radius_m * direction).norm(), kOff_m + 2e-9) << angle;
  }
}

TEST(ObjectContacts, TwoAndThreePlanesHoldItInTheirCorner) {
  Tool two(listOf(PlaneObject(Vec3::Zero(), Vec3::UnitZ()), PlaneObject(Vec3::Zero(), Vec3::UnitX())),
           Vec3::Ones() * 1e-3);
  expectNear(two.at({-2e-3, 5e-3, -3e-3}), {0, 5e-3, 0}, 1.5 * kOff_m);
  Tool three(listOf(PlaneObject(Vec3::Zero(), Vec3::UnitZ()), PlaneObject(Vec3::Zero(), Vec3::UnitX()),
                    PlaneObject(Vec3::Zero(), Vec3::UnitY())),
             Vec3::Ones() * 1e-3);
  expectNear(three.at({-2e-3, -5e-3, -3e-3}), Vec3::Zero(), 1.8 * kOff_m);
  const Vec3 push_W(2e-3, 5e-3, 3e-3);
  EXPECT_LE((three.plane().normal_W - push_W.normalized()).norm(), 1e-3);
}

// A ball of radius R on the floor: in the groove between them the VHIP is on the floor, sqrt(R^2 - (R - 0)^2) = 0 ...
// in general with the ball's centre at height h above the floor the groove is a circle of radius sqrt(R^2 - h^2).
TEST(ObjectContacts, ABallSunkInTheFloorMakesAGroove) {
  const double radius_m = 10e-3;
  const double height_m = 6e-3;  // so the circle has 8 mm
  Tool tool(listOf(PlaneObject(Vec3::Zero(), Vec3::UnitZ()), SphereObject({0, 0, height_m}, radius_m)),
            {12e-3, 0, 1e-3});
  tool.stroke({9e-3, 0, -1e-3}, 50);
  expectNear(tool.stroke({7.5e-3, 0, -1e-3}, 50), {8e-3, 0, 0}, 3 * kOff_m);
  // Around the ball, pressed into the groove: the direction of the HIP counts.
  for (double angle = 0; angle < 6; angle += 0.01) {
    const Vec3 aside(std::cos(angle), std::sin(angle), 0);
    const Vec3 vhip_W = tool.at(7.5e-3 * aside - 1e-3 * Vec3::UnitZ());
    ASSERT_LE((vhip_W - 8e-3 * aside).norm(), 3 * kOff_m) << angle;
  }
}

TEST(ObjectContacts, AMeshCubeIsABox) {
  const Vec3 size_m(20e-3, 30e-3, 10e-3);
  Tool box(listOf(BoxObject(Vec3::Zero(), size_m)), {0, 0, 7e-3});
  ContactObjects cube = {std::make_shared<const MeshObject>(boxMesh(Vec3::Zero(), size_m))};
  Tool mesh(cube, {0, 0, 7e-3});
  // Over the top, off the edge, down the side, around a corner.
  const Vec3 way[] = {
      {0, 0, 3e-3}, {9e-3, 2e-3, 3e-3}, {9.5e-3, 2e-3, -3e-3}, {9e-3, 14.5e-3, -3e-3}, {2e-3, 14e-3, -4e-3}};
  Vec3 from_W(0, 0, 7e-3);
  for (const Vec3& to_W : way) {
    for (int i = 1; i <= 100; ++i) {
      const Vec3 hip_W = from_W + (to_W - from_W) * (i / 100.0);
      ASSERT_LE((box.at(hip_W) - mesh.at(hip_W)).norm(), 1e-9) << hip_W.transpose();
      ASSERT_EQ(box.touching(), mesh.touching());
    }
    from_W = to_W;
  }
}

// On facets at most h wide the VHIP is within the sagitta h^2 / 6R of the ball below it, and never further from the HIP
// than the ball's surface nearest to it.
TEST(ObjectContacts, AMeshSphereIsABallWithinTheSagitta) {
  const double radius_m = 10e-3;
  const TriangleMesh triangles = sphereMesh(Vec3::Zero(), radius_m, 4);
  const double sagitta_m = 1.01 * std::pow(longestEdge(triangles), 2) / (6 * radius_m);
  Tool tool({std::make_shared<const MeshObject>(triangles)}, {0, 0, 11e-3});
  for (double angle = 0; angle < 6; angle += 0.005) {
    const Vec3 direction(std::sin(angle) * std::cos(0.3 * angle), std::sin(angle) * std::sin(0.3 * angle),
                         std::cos(angle));
    const Vec3 vhip_W = tool.at(9e-3 * direction);
    ASSERT_TRUE(tool.touching()) << angle;
    ASSERT_LE(std::abs(vhip_W.norm() - radius_m), sagitta_m + 2 * kOff_m) << angle;
  }
}

// ---- nothing jitters ----

// How much VHIP - HIP, and so the force over K, may change in a tick, per metre that the HIP moves: the map from the
// one to the other is non-expanding for planes at rest (closest_in_planes.hpp), and in a concave corner a plane begins
// to act where it has no effect yet. It begins a stand-off late, when the VHIP on the other plane meets the surface
// itself, and then moves the VHIP back along that plane: by at most kOff / sin(angle between them), 2 um / sin(2 a)
// here for two.
double smooth(double a, double step_m) {
  return 1.001 + 2 * kOff_m / std::sin(2 * a) / step_m;
}

// The V between two planes that open upwards by 2 a, its bottom along y.
std::vector<ContactObjects> wedges(double a) {
  const Vec3 left(std::cos(a), 0, std::sin(a)), right(-std::cos(a), 0, std::sin(a));
  // Boxes behind these planes, and both in one mesh: a block with a V cut into it.
  const auto boxBehind = [](const Vec3& n) {
    Mat3 R_WB;
    R_WB.col(0) = n;
    R_WB.col(1) = Vec3::UnitY();
    R_WB.col(2) = n.cross(Vec3::UnitY());
    return BoxObject(-10e-3 * n, {20e-3, 60e-3, 80e-3}, R_WB);
  };
  const double top_m = 20e-3, wide_m = 20e-3 * std::tan(a);
  const TriangleMesh block = prismMesh({{0, 0},
                                        {-wide_m, top_m},
                                        {-wide_m - 10e-3, top_m},
                                        {-wide_m - 10e-3, -10e-3},
                                        {wide_m + 10e-3, -10e-3},
                                        {wide_m + 10e-3, top_m},
                                        {wide_m, top_m}},
                                       30e-3, {{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}}});
  return {listOf(PlaneObject(Vec3::Zero(), left), PlaneObject(Vec3::Zero(), right)),
          listOf(boxBehind(left), boxBehind(right)),
          {std::make_shared<const MeshObject>(block)}};
}

TEST(ObjectContacts, TheTrialBlockIsAsItShouldBe) {
  const ContactObjects block = wedges(0.5).back();
  EXPECT_TRUE(block.front()->solid());
  EXPECT_TRUE(static_cast<const MeshObject&>(*block.front()).notes().empty());
}

TEST(ObjectContacts, AConcaveCornerDoesNotJitter) {
  for (const double a : {0.2, 0.5, 0.785, 1.2}) {
    int kind = 0;
    for (const ContactObjects& objects : wedges(a)) {
      for (const double step_m : {2e-6, 20e-6, 200e-6}) {
        SCOPED_TRACE(testing::Message() << "half angle " << a << ", kind " << kind << ", step " << step_m);
        Tool tool(objects, {0, 0, 8e-3});
        tool.stroke({0, 0, -0.5e-3}, 300);
        // A press, then across from one wall to the other and back, then along the bottom.
        Vec3 from_W(0, 0, -0.5e-3);
        for (const Vec3& to_W :
             {Vec3(0, 0, -2e-3), Vec3(-4e-3, 1e-3, -1e-3), Vec3(4e-3, -1e-3, -1e-3), Vec3(0, 9e-3, -1e-3)}) {
          const int ticks = static_cast<int>(std::ceil((to_W - from_W).norm() / step_m));
          EXPECT_LE(tool.roughestStroke(to_W, ticks), smooth(a, (to_W - from_W).norm() / ticks)) << to_W.transpose();
          from_W = to_W;
        }
        expectNear(tool.at({0, 9e-3, -1e-3}), {0, 9e-3, 0}, kOff_m / std::sin(a) * 1.01);
        // At rest nothing moves at all.
        const Vec3 rest_W = tool.at({0.1e-3, 9e-3, -1e-3});
        for (int i = 0; i < 100; ++i) ASSERT_LE((tool.at({0.1e-3, 9e-3, -1e-3}) - rest_W).norm(), 1e-12) << i;
      }
      ++kind;
    }
  }
}

// ---- strokes ----

TEST(ObjectContacts, AFastStrokeDoesNotJumpAThinPlate) {
  // 2 m/s at 1 kHz: 2 mm a tick through 0.1 mm, from above and, tilted, across the whole plate.
  const Vec3 size_m(40e-3, 40e-3, 0.1e-3);
  const ContactObjects kinds[] = {listOf(BoxObject(Vec3::Zero(), size_m)),
                                  {std::make_shared<const MeshObject>(boxMesh(Vec3::Zero(), size_m))}};
  for (const ContactObjects& objects : kinds) {
    for (int i = 0; i < 100; ++i) {
      const double offset_m = i * 2e-5;
      Tool tool(objects, {-5e-3, offset_m, 7e-3 + offset_m});
      const Vec3 vhip_W = tool.stroke({3e-3, offset_m, -7e-3 + offset_m}, 8);
      ASSERT_TRUE(tool.touching()) << i;
      ASSERT_NEAR(vhip_W.z(), 0.05e-3, 1.01 * kOff_m) << i;
    }
  }
}

TEST(ObjectContacts, OffTheEdgeOfAPlateItFallsBesideIt) {
  Tool tool(listOf(BoxObject(Vec3::Zero(), {20e-3, 20e-3, 2e-3})), {0, 0, 3e-3});
  tool.stroke({0, 0, -3e-3}, 50);
  EXPECT_TRUE(tool.touching());
  EXPECT_EQ(tool.stroke({12e-3, 0, -3e-3}, 50), Vec3(12e-3, 0, -3e-3));
  EXPECT_FALSE(tool.touching());
}

TEST(ObjectContacts, InsideAtTheStartItFeelsNothingUntilItWasOutside) {
  Tool tool(listOf(BoxObject(Vec3::Zero(), Vec3::Constant(20e-3))), {0, 0, 5e-3});
  tool.stroke({0, 0, 9e-3}, 10);
  EXPECT_FALSE(tool.touching());
  tool.stroke({0, 0, 12e-3}, 10);
  tool.stroke({0, 0, 9e-3}, 10);
  EXPECT_TRUE(tool.touching());
}

// ---- with the plane of a volume ----

// The bone is z < 0, a plate lies in it from -1 to -3 mm: while the bone is there nobody touches the plate.
TEST(ObjectContacts, AnObjectInTheBoneIsNotTouchedWhileTheBoneIs) {
  ObjectContacts contacts(listOf(BoxObject({0, 0, -2e-3}, {20e-3, 20e-3, 2e-3})));
  contacts.reset({0, 0, 1e-3});
  const ContactPlane bone{Vec3::Zero(), Vec3::UnitZ(), 3};
  bool touching = false;
  for (int i = 0; i < 400; ++i) {
    const Vec3 hip_W(i * 1e-5, 0, 1e-3 - i * 1e-5);
    const Vec3 tool_W = contacts.volumeTool(hip_W, touching ? &bone : nullptr);
    // The first tick of the contact may see the plate, should the tick be so fast; the second may not.
    EXPECT_EQ(tool_W, hip_W) << i;
    touching = bone.depth(tool_W) > 0;
    const auto plane = contacts.settle(hip_W, touching ? &bone : nullptr);
    ASSERT_EQ(plane.has_value(), touching) << i;
    EXPECT_EQ(contacts.objectPlanes(), 0) << i;
    if (plane) {
      EXPECT_EQ(plane->normal_W, bone.normal_W);
      EXPECT_EQ(plane->age_ticks, 3);
    }
  }
  EXPECT_TRUE(touching);
}

// A step: the bone's plane and the side of a box on it. The volume's tool is under the corner, as deep behind the
// bone's plane as the box's side alone would let it be.
TEST(ObjectContacts, TheVolumesToolIsUnderTheVhip) {
  ObjectContacts contacts(listOf(BoxObject({10e-3, 0, 0}, {20e-3, 20e-3, 20e-3})));
  contacts.reset({-1e-3, 0, 1e-3});
  const ContactPlane bone{Vec3::Zero(), Vec3::UnitZ(), 0};
  const Vec3 hip_W(2e-3, 1e-3, -3e-3);
  const Vec3 tool_W = contacts.volumeTool(hip_W, &bone);
  expectNear(tool_W, {0, 1e-3, -3e-3}, 2 * kOff_m);
  const auto plane = contacts.settle(hip_W, &bone);
  ASSERT_TRUE(plane);
  expectNear(contacts.vhip_W(), {0, 1e-3, 0}, 2 * kOff_m);
  EXPECT_LE((plane->normal_W - Vec3(-2, 0, 3).normalized()).norm(), 1e-3);
}

// The volume's plane against an object with no room between: the object wins, and the tool rests.
// The volume's plane was found anew after the tool was asked for: the VHIP is that of the new plane, as if the old one
// had never been.
TEST(ObjectContacts, SettlesOnThePlaneThatItIsGivenLast) {
  const PlaneObject wall(Vec3::Zero(), Vec3::UnitX());
  const Vec3 start_W(2e-3, 0, 2e-3), hip_W(-1e-3, 0, -1e-3);
  const ContactPlane old_plane{Vec3(0, 0, 1e-3), Vec3::UnitZ(), 3};
  const ContactPlane planes[] = {{Vec3(0, 0, 0.4e-3), Vec3::UnitZ(), 0},
                                 {Vec3(0, 0, 1e-3), Vec3(-0.3, 0, 1).normalized(), 0}};
  for (const ContactPlane& plane : planes) {
    ObjectContacts told(listOf(wall)), fresh(listOf(wall));
    told.reset(start_W);
    fresh.reset(start_W);
    (void)told.volumeTool(hip_W, &old_plane);
    (void)fresh.volumeTool(hip_W, &plane);
    const auto got = told.settle(hip_W, &plane), want = fresh.settle(hip_W, &plane);
    ASSERT_TRUE(got && want);
    expectNear(told.vhip_W(), fresh.vhip_W(), 1e-12);
    EXPECT_NEAR(plane.depth(told.vhip_W()), 0, 1e-9);  // kPlaneSoftness of 1.4 mm
    EXPECT_EQ(got->age_ticks, 0);
    // And where the volume lets go meanwhile, the wall alone holds it.
    told.reset(start_W);
    (void)told.volumeTool(hip_W, &old_plane);
    ASSERT_TRUE(told.settle(hip_W, nullptr));
    expectNear(told.vhip_W(), Vec3(0, 0, hip_W.z()), 1.01 * kOff_m);
  }
}

TEST(ObjectContacts, WithoutRoomTheObjectWins) {
  ObjectContacts contacts(listOf(PlaneObject({0, 0, 1e-3}, -Vec3::UnitZ())));
  contacts.reset(Vec3::Zero());
  const ContactPlane bone{{0, 0, 2e-3}, Vec3::UnitZ(), 0};
  for (int i = 0; i < 100; ++i) {
    const Vec3 hip_W(0, 0, -1e-3);
    (void)contacts.volumeTool(hip_W, &bone);
    ASSERT_TRUE(contacts.settle(hip_W, &bone));
    ASSERT_LE(contacts.vhip_W().z(), 1e-3) << i;
  }
  EXPECT_NEAR(contacts.vhip_W().z(), 1e-3, 4 * kOff_m);
}

TEST(ObjectContacts, TurningAndMovingTheWorldTurnsAndMovesTheTrace) {
  const Mat3 R =
      (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(-2.1, Vec3::UnitX())).toRotationMatrix();
  const Vec3 t_W(0.03, -0.02, 0.05);
  const auto moved = [&](const Vec3& p_W) -> Vec3 { return R * p_W + t_W; };
  TriangleMesh plate = boxMesh({0, 0, -2e-3}, {30e-3, 30e-3, 4e-3});
  TriangleMesh moved_plate = plate;
  for (Vec3& vertex : moved_plate.vertices_W) vertex = moved(vertex);
  const auto make = [&](const auto& place, const Mat3& turn, const TriangleMesh& mesh) {
    ContactObjects objects = listOf(SphereObject(place({8e-3, 0, 2e-3}), 5e-3),
                                    BoxObject(place({-8e-3, 0, 2e-3}), {6e-3, 20e-3, 8e-3}, turn),
                                    PlaneObject(place({0, 12e-3, 0}), turn * -Vec3::UnitY()));
    objects.push_back(std::make_shared<const MeshObject>(mesh));
    return objects;
  };
  Tool here(make([](const Vec3& p) { return p; }, Mat3::Identity(), plate), {0, 0, 8e-3});
  Tool there(make(moved, R, moved_plate), moved({0, 0, 8e-3}));
  const Vec3 way[] = {{0, 0, -2e-3}, {6e-3, 0, -1e-3}, {7e-3, 13e-3, -1e-3}, {-7e-3, 14e-3, -2e-3}, {-6e-3, 0, -2e-3}};
  Vec3 from_W(0, 0, 8e-3);
  for (const Vec3& to_W : way) {
    for (int i = 1; i <= 200; ++i) {
      const Vec3 hip_W = from_W + (to_W - from_W) * (i / 200.0);
      // Roundings of 0.1 m through pushes and turns; a plane of the ball follows the VHIP to within 1 nm.
      ASSERT_LE((moved(here.at(hip_W)) - there.at(moved(hip_W))).norm(), 1e-8) << hip_W.transpose();
      ASSERT_EQ(here.touching(), there.touching());
    }
    from_W = to_W;
  }
}

}  // namespace object_contacts_test
}  // namespace palpate
