// SPDX-License-Identifier: Apache-2.0
// A run loads the libraries that its scene needs and no others. The loader of the running program counts them
// (summary.json, "libraries").
#include <array>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace libraries_test {

using nlohmann::json;
using Names = std::set<std::string>;

// The modules of Palpate, and how the names of the libraries begin that each brings.
struct Module {
  std::string name;
  std::vector<std::string> brings;
};
const std::vector<Module>& modules() {
  static const std::vector<Module> kModules = {{"openvdb", {"libopenvdb.", "liblog4cplus"}},
                                               {"itk", {"libITK"}},
                                               {"gdcm", {"libgdcm"}},
                                               {"invesalius", {"libarchive.", "libplist"}},
                                               {"embree", {"libembree"}},
                                               {"assimp", {"libassimp."}},
                                               {"cairo", {"libcairo.", "libfontconfig.", "libpixman"}},
                                               {"hidraw", {"libhidapi-hidraw."}},
                                               {"hidusb", {"libhidapi-libusb."}},
                                               {"rivals", {}}};
  return kModules;
}

class Libraries : public ProgramTest {
 protected:
  // What a run of `touch` with these words had loaded.
  [[nodiscard]] Names loadedBy(const Words& touch) const {
    const Outcome outcome = run(touch);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json summary = json::parse(contentsOf(file("out/summary.json")));
    return summary["libraries"].get<Names>();
  }

  // Exactly these modules, and of the outside libraries exactly those of these modules.
  void expectModules(const Words& touch, const Names& expected) const {
    const Names loaded = loadedBy(touch);
    for (const Module& module : modules()) {
      const bool wanted = expected.contains(module.name);
      EXPECT_EQ(loaded.contains(module.name + ".so"), wanted) << module.name;
      for (const std::string& library : module.brings) {
        const auto found = loaded.lower_bound(library);
        EXPECT_EQ(found != loaded.end() && found->starts_with(library), wanted) << library;
      }
    }
    // What belongs to a desktop is in the program with the window alone.
    for (const std::string& name : loaded) EXPECT_FALSE(name.starts_with("libglfw") || name.starts_with("libimgui"));
  }

  // A way that meets nothing, for volumes on which no path is to be found.
  void writeWay() const { write("way.csv", "time_s,x_m,y_m,z_m\n0,9,0,0.01\n0.1,9,0,0\n"); }
};

TEST_F(Libraries, ABareTouchOfAPhantomLoadsOpenVdbAlone) {
  expectModules(quickTouch("phantom:sphere?size=16"), {"openvdb"});
}

TEST_F(Libraries, APictureLoadsCairo) {
  expectModules({"touch", "phantom:sphere?size=16", "--seconds", "0.1", "--clock", "simulated", "--out", "out"},
                {"openvdb", "cairo"});
}

TEST_F(Libraries, ObjectsOfFormulasLoadNothing) {
  expectModules(quickTouch("phantom:sphere?size=16", {"--object", "plane:point=0,0,-90:normal=0,0,1"}), {"openvdb"});
}

TEST_F(Libraries, MeshesLoadEmbreeAndTheirFormatAssimp) {
  write("plate.obj", "v -2 -2 0\nv 2 -2 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  write("plate.stl",
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid\n");
  expectModules(quickTouch("phantom:sphere?size=16", {"--object", "mesh:position=200,0,0:file=plate.stl"}),
                {"openvdb", "embree"});
  expectModules(quickTouch("phantom:sphere?size=16", {"--object", "mesh:position=200,0,0:file=plate.obj"}),
                {"openvdb", "embree", "assimp"});
  expectModules(quickTouch("phantom:sphere?size=16", {"--algorithm", "god-object"}), {"openvdb", "embree"});
}

TEST_F(Libraries, FormatsLoadTheirOwnLibrary) {
  for (const char* name : {"a.vdb", "a.nii.gz", "a.nrrd", "a.mha"})
    expectSuccess(run({"convert", "phantom:sphere?size=16", name}));
  expectModules(quickTouch("a.vdb"), {"openvdb"});
  expectModules(quickTouch("a.nii.gz"), {"openvdb"});  // its header has a reader of our own
  expectModules(quickTouch("a.nrrd"), {"openvdb", "itk"});
  expectModules(quickTouch("a.mha"), {"openvdb", "itk"});
}

// Its pixels are plain bytes, so nothing has to be unpacked.
TEST_F(Libraries, DicomLoadsNothing) {
  std::filesystem::create_directory(file("scan"));
  for (int k = 0; k < 4; ++k) {
    DicomFields fields;
    fields.sop = fmt::format("1.2.{}", k + 1);
    fields.position = fmt::format("0\\0\\{}", k);
    fields.columns = fields.rows = 4;
    for (int n = 0; n < 16; ++n) fields.pixels.push_back(k < 2 ? 100 : 0);
    write(fmt::format("scan/{}.dcm", k), dicomBytes(fields));
  }
  writeWay();
  expectModules(quickTouchAlong("way.csv", "scan"), {"openvdb"});
}

TEST_F(Libraries, AnInvesaliusProjectLoadsItsArchivers) {
  writeTarGz(file("a.inv3"),
             {{"main.plist", invesaliusPlist()}, {"matrix.dat", bytesOf<std::int16_t>(rampValues(-30))}});
  writeWay();
  expectModules(quickTouchAlong("way.csv", "a.inv3"), {"openvdb", "invesalius"});
}

// The time to the first tick lies within what the whole run took.
TEST_F(Libraries, TheStartIsTimed) {
  const Outcome outcome = run(quickTouch("phantom:sphere?size=16"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json summary = json::parse(contentsOf(file("out/summary.json")));
  const double start_ms = summary["servo"]["start_to_first_tick_ms"];
  double stages_ms = 0;
  for (const json& stage : summary["stages"])
    if (stage["name"] != "servo") stages_ms += 1e3 * stage["seconds"].get<double>();
  EXPECT_GT(start_ms, stages_ms);
  EXPECT_LT(start_ms, 1e3 * outcome.seconds);
}

// A program that was copied without its modules says what it lacks, where it looked and what to do. What needs none
// still works.
TEST_F(Libraries, AModuleThatIsMissingIsTold) {
  std::filesystem::create_directories(file("alone/bin"));
  std::filesystem::copy_file(PALPATE_PROGRAM, file("alone/bin/palpate"));
  const auto runAlone = [&](const Words& words) {
    return runPalpate({.arguments = words, .program = file("alone/bin/palpate").string(), .folder = folder()});
  };
  EXPECT_EQ(runAlone({"--version"}).status, 0);
  EXPECT_EQ(runAlone({"scene"}).status, 0);
  expectRefusal(runAlone({"info", "phantom:sphere"}), file("alone/lib/palpate/openvdb.so").string(),
                "this part of Palpate is missing", 3);
  std::filesystem::create_directories(file("alone/lib"));
  std::filesystem::create_directory_symlink(
      std::filesystem::path(PALPATE_PROGRAM).parent_path().parent_path() / "lib/palpate", file("alone/lib/palpate"));
  EXPECT_EQ(runAlone({"info", "phantom:sphere"}).status, 0);
}

}  // namespace libraries_test
}  // namespace palpate
