// SPDX-License-Identifier: Apache-2.0
// Objects beside the volume, from the command line and from scene files, and the god-object, end to end.
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "trace.hpp"

namespace palpate {
namespace objects_test {

using nlohmann::json;

class Objects : public ProgramTest {
 protected:
  // Down beside the ball, where nothing is but the object, 5 mm deep at the end.
  void writeWay() const { write("way.csv", "time_s,x_m,y_m,z_m\n0,0.1,0,0.01\n0.1,0.1,0,0\n0.2,0.1,0,-0.005\n"); }
  [[nodiscard]] Trace touch(const Words& more) const {
    writeWay();
    expectSuccess(run(quickTouchAlong("way.csv", "phantom:sphere?size=16", more)));
    return readTrace(file("out/trace.csv"));
  }
};

// The VHIP is 1 um in front of a plane (servo/objects/object_contacts.hpp).
TEST_F(Objects, ABoxOnTheCommandLineIsFelt) {
  const Trace trace = touch({"--object", "box:centre=100,0,-10:size=20,20,20:rotation=0,0,30"});
  EXPECT_FALSE(trace.rows.front().inContact());
  ASSERT_TRUE(trace.rows.back().inContact());
  EXPECT_NEAR(trace.rows.back().vhip_W().z(), 0, 2e-6);
  EXPECT_LT(trace.rows.back().hip_W().z(), -4.9e-3);
  const json summary = json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["scene"]["objects"], json({"box:centre=100,0,-10:size=20,20,20:rotation=0,0,30"}));
  EXPECT_TRUE(summary["exact"].is_null());
  EXPECT_THAT(summary["command"].get<std::string>(), testing::HasSubstr("--object box:centre=100,0,-10"));
}

TEST_F(Objects, SceneFileAndFlagsAdd) {
  // A tetrahedron in inches whose lowest face is turned up by the scene: its top is a plane 4 mm below the world's
  // origin.
  std::filesystem::create_directories(file("meshes"));
  write("meshes/plate.obj", "v -2 -2 0\nv 2 -2 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  write("meshes/scene.toml",
        "volume = 'phantom:sphere?size=16'\n[[object]]\nkind = 'mesh'\nfile = 'plate.obj'\nunit = 'in'\n"
        "position_mm = [100, 0, -4]\nrotation_deg = [180, 0, 0]\n");
  writeWay();
  const Words quick = {"touch",  "meshes/scene.toml", "--clock", "simulated", "--picture", "off",
                       "--path", "way.csv",           "--out",   "out"};
  expectSuccess(run(quick));
  EXPECT_NEAR(readTrace(file("out/trace.csv")).rows.back().vhip_W().z(), -4e-3, 2e-6);
  expectSuccess(run(quick + Words{"--object", "plane:point=0,0,-2:normal=0,0,1"}));
  EXPECT_NEAR(readTrace(file("out/trace.csv")).rows.back().vhip_W().z(), -2e-3, 2e-6);
  const json summary = json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["scene"]["objects"].size(), 2U);
}

// A sheet has no inside; and the tool begins within the box.
TEST_F(Objects, WhatIsOddAboutOneIsTold) {
  write("sheet.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n");
  static_cast<void>(
      touch({"--object", "mesh:position=200,0,0:file=sheet.obj", "--object", "box:centre=100,0,10:size=2,2,2"}));
  const json notes = json::parse(contentsOf(file("out/summary.json")))["notes"];
  EXPECT_THAT(notes.dump(), testing::HasSubstr("sheet.obj: the mesh is not closed, so it is touched from both sides"));
  EXPECT_THAT(notes.dump(), testing::HasSubstr("object 2 (box): the tool starts inside it"));
}

TEST_F(Objects, TheGodObjectTouchesTheIsosurfacesMesh) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--algorithm", "god-object"})));
  const json summary = json::parse(contentsOf(file("out/summary.json")));
  EXPECT_GT(summary["contact"]["ticks"], 100);
  // A mesh vertex is off by (0.75 / 2 + 1 / 8) h^2 / R, 0.06 voxel at R = 8; twice for a facet's middle.
  EXPECT_LT(summary["exact"]["vhip_p99_voxel"], 0.15);
  EXPECT_THAT(summary["plan"].dump(), testing::HasSubstr("done: mesh of the isosurface, "));
  EXPECT_THAT(summary["stages"].dump(), testing::HasSubstr("isosurface mesh"));
}

TEST_F(Objects, RefusalsNameTheObject) {
  const auto refused = [&](const std::string& object) {
    return run(quickTouch("phantom:sphere?size=16", {"--object", object}));
  };
  expectRefusal(refused("ball:radius=5"), "--object 'ball:radius=5'", "no object of kind 'ball'", 2);
  expectRefusal(refused("mesh:file=none.stl"), "none.stl", "there is no such file", 3);
  write("words.stl", "these are words");
  expectRefusal(refused("mesh:file=words.stl"), "words.stl", "no STL file", 2);
  write("wide.obj", "v 0 0 0\nv 3000 0 0\nv 0 3000 0\nf 1 2 3\n");
  expectRefusal(refused("mesh:file=wide.obj"), "wide.obj", "the mesh is 3000 mm wide", 2);
}

}  // namespace objects_test
}  // namespace palpate
