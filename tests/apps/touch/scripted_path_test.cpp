// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scripted_path.hpp"

#include <gtest/gtest.h>

#include "apps/path/touch_path.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/phantoms/phantom.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace scripted_path_test {

class ScriptedPathTest : public testing::Test {
 protected:
  [[nodiscard]] ScriptedPath path(const Scene& scene) const { return scriptedPath(scene, VolumeSurface(volume_, 0)); }
  TemporaryFolder folder_;
  Volume volume_ = loadVolume("phantom:sphere?size=24");
};

TEST_F(ScriptedPathTest, OfTheSurfaceTakesTheWishesOfTheScene) {
  Scene scene;
  scene.duration_s = 2;
  scene.press_depth_m = 1.5e-3;
  scene.path_toward = Vec3(0, -1, 0);
  const ScriptedPath built = path(scene);
  EXPECT_EQ(built.path.duration_s(), 2);
  ASSERT_EQ(built.phases.size(), 4U);
  EXPECT_EQ(built.phases[2].name, "slide");
  const Vec3 begin_W = built.path.position(0), low_W = built.path.position(built.phases[1].end_s);
  EXPECT_LT((low_W - begin_W).normalized().y(), -0.99);
  // The lowest point lies a depth below the surface; trilinear interpolation of a ball of 8 voxels' radius is off by
  // less than h^2 / (8 R) times the three axes, some 0.05 voxel.
  const auto sphere = makePhantom("phantom:sphere?size=24");
  EXPECT_NEAR(sphere->signedDistance_m(low_W), -1.5e-3, 0.1e-3);
}

// A box of 16 mm, whose edge the slide reaches after 3 of 9 mm. What the scene says is what the path is built from.
TEST_F(ScriptedPathTest, TakesEveryWishOfTheScene) {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(1e-3);
  lattice.origin_W = Vec3::Constant(-15.5e-3);
  std::vector<float> values;
  for (int n = 0; n < 32 * 32 * 32; ++n) {
    const Vec3 p_L = Vec3i(n % 32, n / 32 % 32, n / 1024).cast<double>() - Vec3::Constant(15.5);
    values.push_back(static_cast<float>(8 - p_L.cwiseAbs().maxCoeff()));
  }
  const Volume box = Volume::fromDense(Vec3i::Constant(32), lattice, values, {});
  const VolumeSurface surface(box, 0);
  Scene scene;
  scene.duration_s = 3;
  scene.approach_m = 2.5e-3;
  scene.press_depth_m = 0.75e-3;
  scene.slide_length_m = 9e-3;
  scene.path_start_W = Vec3(5e-3, 1e-3, 8e-3);
  scene.path_slide = Vec3(1, 0, 0);
  PathRequest request{.duration_s = 3,
                      .approach_m = 2.5e-3,
                      .press_depth_m = 0.75e-3,
                      .slide_length_m = 9e-3,
                      .over_edges = OverEdges::kFollow,
                      .toward_W = std::nullopt,
                      .start_W = Vec3(5e-3, 1e-3, 8e-3),
                      .slide_W = Vec3(1, 0, 0)};
  std::vector<Vec3> ends;
  for (const bool straight : {false, true}) {
    scene.straight_over_edges = straight;
    request.over_edges = straight ? OverEdges::kStraight : OverEdges::kFollow;
    const ScriptedPath built = scriptedPath(scene, surface);
    const TouchPath wanted = buildTouchPath(surface, request);
    ASSERT_EQ(built.phases.size(), 4U);
    for (const TimedPoint& point : wanted.points) {
      ASSERT_LT((built.path.position(point.time_s) - point.p_W).norm(), 1e-15) << point.time_s;
    }
    EXPECT_EQ(built.notes, wanted.notes);
    EXPECT_EQ(built.depth_m, 0.75e-3);
    EXPECT_EQ(built.slide_m, wanted.slid_m);
    EXPECT_EQ(built.approach_m, wanted.approach_m);
    EXPECT_NEAR(wanted.approach_m, 2.5e-3, 1e-6);
    ends.push_back(built.path.position(built.phases[2].end_s));
  }
  EXPECT_GT((ends[0] - ends[1]).norm(), 2e-3);  // around the edge, or straight on
}

// Between its rows a file's path is smooth, not a polygon.
TEST_F(ScriptedPathTest, OfAFileIsCubicBetweenItsRows) {
  std::ofstream(folder_.path() / "way.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,1\n2,0,0,0\n";
  Scene scene;
  scene.path_file = (folder_.path() / "way.csv").string();
  const ScriptedPath read = path(scene);
  const SampledPath cubic({0, 1, 2}, {Vec3::Zero(), Vec3::UnitZ(), Vec3::Zero()}, SampledPath::Interpolation::kCubic);
  for (const double time_s : {0.25, 0.75, 1.25}) EXPECT_EQ(read.path.position(time_s), cubic.position(time_s));
  EXPECT_GT(read.path.position(0.75).z(), 0.8);  // a straight line would be at 0.75
}

TEST_F(ScriptedPathTest, OfAFileIsThatFile) {
  std::ofstream(folder_.path() / "way.csv") << "time_s,x_m,y_m,z_m\n1,0,0,0\n1.5,0,0,0.5\n2,0,0,1\n";
  Scene scene;
  scene.duration_s = 99;
  scene.path_file = (folder_.path() / "way.csv").string();
  const ScriptedPath read = path(scene);
  EXPECT_EQ(read.path.duration_s(), 1);
  EXPECT_TRUE(read.phases.empty());
  EXPECT_NEAR(read.path.position(0.25).z(), 0.25, 1e-15);
}

// The volume's box ends 11.5 voxels of 1 mm from the origin: z from 5 m down to 1 m comes no nearer than 988.5 mm.
TEST_F(ScriptedPathTest, SaysThatAFileInMillimetresNeverEntersTheVolume) {
  std::ofstream(folder_.path() / "mm.csv") << "time_s,x_m,y_m,z_m\n0,0,0,5\n1,0,0,1\n";
  Scene scene;
  scene.path_file = (folder_.path() / "mm.csv").string();
  const ScriptedPath read = path(scene);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("988 mm away; are its coordinates in metres"), std::string::npos) << read.notes[0];
}

// 23 mm along each axis are 39.8 mm across: a path may go ten times as far away, 0.398 m from the box's face.
TEST_F(ScriptedPathTest, SaysThatAPathGoesFarAway) {
  Scene scene;
  scene.path_file = (folder_.path() / "mm.csv").string();
  for (const auto& [z_m, told] : {std::pair{30.0, true}, {0.4115, true}, {0.4085, false}}) {
    std::ofstream(scene.path_file) << "time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0," << z_m << "\n";
    const std::vector<std::string> notes = path(scene).notes;
    ASSERT_EQ(notes.size(), told ? 1U : 0U) << z_m;
    if (z_m == 30) {
      EXPECT_EQ(notes[0],
                "the path goes 30 m away from the volume, which is 0.0398 m across; are its coordinates in "
                "metres?");
    }
  }
}

// Voxels of 4 mm along z: the box ends 46 mm from the origin there.
TEST_F(ScriptedPathTest, MeasuresTheWayToAVolumeOfFlatVoxels) {
  std::ofstream(folder_.path() / "mm.csv") << "time_s,x_m,y_m,z_m\n0,0,0,5\n1,0,0,1\n";
  Scene scene;
  scene.path_file = (folder_.path() / "mm.csv").string();
  const Volume flat = loadVolume("phantom:sphere?size=24&spacing=1x2x4mm");
  const ScriptedPath read = scriptedPath(scene, VolumeSurface(flat, 0));
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("its nearest point is 954 mm away"), std::string::npos) << read.notes[0];
}

// The ball's radius is 0.4 of 24 mm at most; nothing was asked for, so all three fit it (path_fit.hpp).
TEST_F(ScriptedPathTest, SaysWhatItChose) {
  const ScriptedPath built = path({});
  EXPECT_EQ(built.depth_m, 1e-3);
  EXPECT_GT(built.slide_m.value_or(0), 8e-3);
  EXPECT_LT(built.slide_m.value_or(1), 20e-3);
  EXPECT_GT(built.approach_m.value_or(0), 7e-3);
  EXPECT_LT(built.approach_m.value_or(1), 10e-3);
}

TEST_F(ScriptedPathTest, OfAFileThroughTheVolumeNeedsNoNote) {
  std::ofstream(folder_.path() / "way.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0.02\n1,0,0,0.005\n";
  Scene scene;
  scene.path_file = (folder_.path() / "way.csv").string();
  EXPECT_TRUE(path(scene).notes.empty());
}

TEST_F(ScriptedPathTest, OfAMissingFileIsRefused) {
  Scene scene;
  scene.path_file = (folder_.path() / "nowhere.csv").string();
  EXPECT_THROW((void)path(scene), Error);
}

}  // namespace scripted_path_test
}  // namespace palpate
