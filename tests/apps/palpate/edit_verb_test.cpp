// SPDX-License-Identifier: Apache-2.0
// palpate edit, as a user gives it: against commands made by hand and applied by the CPU twin, against a formula, and
// against what recover makes of its journal; and every refusal.
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "base/vec.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_keys.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_reader.hpp"
#include "engine/reference/edit.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace edit_verb_test {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

constexpr const char* kVolume = "phantom:sphere?size=32";  // radius some 10 mm, 1 mm voxels, densities -1000 to 1000
constexpr double kIsovalue = 0;

// A closed tetrahedron, as the lines of an OBJ file; the last face closes it.
constexpr const char* kOpenMesh = "v 0 0 0\nv 6 0 0\nv 0 6 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
const std::string kMesh = std::string(kOpenMesh) + "f 2 3 4\n";

class EditVerb : public ProgramTest {
 protected:
  // Edits the phantom into out.nrrd.
  [[nodiscard]] Outcome edit(const Words& more) const { return run(Words{"edit", kVolume, "out.nrrd"} + more); }
  [[nodiscard]] Volume out(const char* name = "out.nrrd") const { return loadVolume(file(name).string()); }
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(contentsOf(file("result.json"))); }
  // Nothing is left behind where OUT was to be.
  void expectNothingWritten() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder()))
      EXPECT_FALSE(entry.path().filename().string().starts_with("out.")) << entry.path();
  }
};

Words dos(const Words& commands) {
  Words words;
  for (const std::string& command : commands) words = words + Words{"--do", command};
  return words;
}

std::string contentIn(const std::string& text) {
  const std::size_t at = text.find("content ");
  return at == std::string::npos ? "none" : text.substr(at + 8, 16);
}

EditCommand brush(EditKind kind, double radius_m, const Vec3& at_W) {
  EditCommand command;
  command.kind = kind;
  command.radius_m = radius_m;
  command.from_W = command.to_W = at_W;
  return command;
}

// A dab at c of radius r (docs/edits.md): f' = min(f, max(background, tau - slope (r - d))) up to r + band, f beyond.
// Floats: p and c count from a voxel near by and are below 8 mm, so their differences are off by at most 3 roundings,
// 3 * 2^-24 * 8e-3 m = 1.4e-9 m an axis, the square root by as much again: d by less than 5e-9 m, which the ramp turns
// into slope * 5e-9. What is stored and the ramp's ends are rounded at 1000, twice: 1000 * 2^-23.
TEST_F(EditVerb, ARemovedBallIsWhatTheFormulaSays) {
  expectSuccess(edit(dos({"remove:radius=5mm:at=6.3,-2.1,4.4mm"})));
  const Volume before = loadVolume(kVolume);
  const Volume after = out();
  const BrushProfile profile = brushProfile(before, kIsovalue);
  const double tolerance = profile.slope_per_m * 5e-9 + 1000.0 / 8388608;
  const Vec3 c_W(6.3e-3, -2.1e-3, 4.4e-3);
  int changed = 0;
  Vec3i v;
  for (v.z() = 0; v.z() < 32; ++v.z()) {
    for (v.y() = 0; v.y() < 32; ++v.y()) {
      for (v.x() = 0; v.x() < 32; ++v.x()) {
        const double d_m = (before.lattice().toWorld(v.cast<double>()) - c_W).norm();
        const double f = static_cast<double>(before.value(v));
        const double g = std::max(profile.background, profile.isovalue - profile.slope_per_m * (5e-3 - d_m));
        const double expected = d_m > 5e-3 + profile.band_m ? f : std::min(f, g);
        ASSERT_NEAR(static_cast<double>(after.value(v)), expected, tolerance) << v.transpose();
        if (after.value(v) != before.value(v)) ++changed;
      }
    }
  }
  EXPECT_GT(changed, 400);  // the ball alone has 4/3 pi 5^3 = 524 voxels, of which a part was outside before
}

// Every kind as text is what the API's command is, bit for bit; commands follow one another as they are given.
TEST_F(EditVerb, EveryKindIsTheCommandOfTheApi) {
  write("tet.obj", kMesh);
  expectSuccess(edit(
      dos({"add:radius=4:at=9,0,0:density=700", "remove:radius=3mm:from=-9,0,0:to=0,0,9:strength=0.7",
           "paint:radius=4:at=0,8,0:value=120:falloff=0.5", "smooth:radius=6:at=0,0,-9", "inflate:radius=5:at=0,-9,0",
           "deflate:radius=5:at=0,9,0:mirror=y", "flatten:radius=6:at=0,0,9.5:point=0,0,8:normal=0,0.2,1",
           "cut:point=0,-9,0:normal=0,-1,0", "stamp-add:mesh=tet.obj:at=8,-2,2:turn=10,20,30",
           "stamp-remove:mesh=tet.obj:at=-9,1,1", "remove:radius=2:at=9,0,0:soft=100:hard=800:drop=0.9:mirror=x"})));
  Volume volume = loadVolume(kVolume);
  const BrushProfile profile = brushProfile(volume, kIsovalue);
  const Vec3 middle_W = volume.lattice().toWorld(Vec3::Constant(15.5));
  std::vector<std::vector<EditCommand>> edits;
  edits.push_back({brush(EditKind::kAdd, 4e-3, {9 * 1e-3, 0, 0})});
  edits.back()[0].object = 700;
  edits.push_back({brush(EditKind::kRemove, 3e-3, {-9 * 1e-3, 0, 0})});
  edits.back()[0].to_W = {0, 0, 9 * 1e-3};
  edits.back()[0].strength = 0.7;
  edits.push_back({brush(EditKind::kPaint, 4e-3, {0, 8 * 1e-3, 0})});
  edits.back()[0].value = 120;
  edits.back()[0].falloff = 0.5;
  edits.push_back({brush(EditKind::kSmooth, 6e-3, {0, 0, -9 * 1e-3})});
  edits.push_back({brush(EditKind::kInflate, 5e-3, {0, -9 * 1e-3, 0})});
  edits.push_back({brush(EditKind::kDeflate, 5e-3, {0, 9 * 1e-3, 0})});
  edits.back().push_back(mirrored(edits.back()[0], middle_W, Vec3::UnitY()));
  edits.push_back({brush(EditKind::kFlatten, 6e-3, {0, 0, 9.5 * 1e-3})});
  edits.back()[0].plane_W = {0, 0, 8 * 1e-3};
  edits.back()[0].normal_W = {0, 0.2, 1};
  edits.push_back({brush(EditKind::kCut, 0, Vec3::Zero())});
  edits.back()[0].plane_W = {0, -9 * 1e-3, 0};
  edits.back()[0].normal_W = {0, -1, 0};
  const double h = 6 * 1e-3;
  const auto stamp = std::make_shared<const Stamp>(meshDistance({{0, 0, 0}, {0, 0, h}, {0, h, 0}, {h, 0, 0}},
                                                                {{0, 2, 3}, {0, 3, 1}, {0, 1, 2}, {3, 2, 1}}, 1e-3,
                                                                profile.band_m, rampDepth(profile, profile.object)));
  edits.push_back({brush(EditKind::kStampAdd, 0, Vec3(8, -2, 2) * 1e-3)});
  edits.back()[0].stamp = stamp;
  edits.back()[0].R_WS = rotationOf({10, 20, 30});
  edits.push_back({brush(EditKind::kStampRemove, 0, Vec3(-9, 1, 1) * 1e-3)});
  edits.back()[0].stamp = stamp;
  edits.push_back({brush(EditKind::kRemove, 2e-3, {9 * 1e-3, 0, 0})});
  edits.back()[0].material = MaterialRate{100, 800, 0.9};
  edits.back().push_back(mirrored(edits.back()[0], middle_W, Vec3::UnitX()));
  for (const auto& commands : edits)
    reference::applyEdits(volume, lowerEdits(commands, volume.size(), volume.lattice(), profile));
  const std::vector<float> expected = volume.toDense();
  const std::vector<float> got = out().toDense();
  ASSERT_EQ(got.size(), expected.size());
  EXPECT_EQ(std::memcmp(got.data(), expected.data(), got.size() * sizeof(float)), 0);
  EXPECT_NE(contentHash(volume), contentHash(loadVolume(kVolume)));
}

TEST_F(EditVerb, UndoBringsTheOriginalBackAndRedoTheEdit) {
  const std::string drill = "remove:radius=5mm:at=6,0,0";
  const std::string original = fmt::format("{:016x}", contentHash(loadVolume(kVolume)));
  const std::string edited = contentIn(edit(dos({drill})).out);
  EXPECT_NE(edited, original);
  const Outcome undone = edit(dos({drill, "undo"}));
  expectSuccess(undone);
  EXPECT_EQ(contentIn(undone.out), original);
  EXPECT_EQ(contentHash(out()), contentHash(loadVolume(kVolume)));
  EXPECT_THAT(undone.out, HasSubstr("2 applied: 1 edit, 1 undo, 0 redos; 0 refused"));
  EXPECT_EQ(contentIn(edit(dos({drill, "undo", "redo"})).out), edited);
  // Both sides of a mirror are one edit.
  EXPECT_EQ(contentIn(edit(dos({drill + ":mirror=x", "undo"})).out), original);
}

// The same hash, and the same bytes where a format has no random part; a mesh too.
TEST_F(EditVerb, RecoverMakesTheSameFileFromTheJournal) {
  write("tet.obj", kMesh);
  const Outcome edited = edit(dos({"remove:radius=5:at=6,0,0", "smooth:radius=6:at=0,6,0", "undo",
                                   "stamp-add:mesh=tet.obj:at=8,0,0:mirror=z", "redo", "add:radius=3:at=-9,0,0"}) +
                              Words{"--journal", "journal", "--keep-going"});
  EXPECT_EQ(edited.status, 0);
  EXPECT_THAT(edited.err, HasSubstr("'redo': redo: nothing was undone; undo an edit first (left out)"));
  EXPECT_THAT(edited.out, HasSubstr("5 applied: 4 edits, 1 undo, 0 redos; 1 refused"));
  EXPECT_THAT(edited.out, HasSubstr("6 of 6 records saved in journal"));  // the stamp is one
  const Outcome recovered = run({"recover", "journal", "--out", "back.nrrd"});
  expectSuccess(recovered);
  EXPECT_EQ(contentIn(recovered.out), contentIn(edited.out));
  EXPECT_EQ(contentsOf(file("back.nrrd")), contentsOf(file("out.nrrd")));
  expectSuccess(run({"recover", "journal", "--out", "back.vdb"}));
  EXPECT_EQ(contentHash(out("back.vdb")), contentHash(out()));
  expectSuccess(run({"recover", "journal", "--out", "back.stl"}));
  expectSuccess(run({"convert", "out.nrrd", "direct.stl", "--iso", "0"}));
  EXPECT_EQ(contentsOf(file("back.stl")).substr(80), contentsOf(file("direct.stl")).substr(80));
}

// 150 is nobody's guess: the phantom says 0. A later --iso goes before it; a distance has its surface at 0.
TEST_F(EditVerb, AVdbKeepsTheIsovalueThatItWasEditedAt) {
  const Words drill = dos({"remove:radius=5:at=6,0,0"});
  expectSuccess(run(Words{"edit", kVolume, "out.vdb", "--iso", "150", "--journal", "journal"} + drill));
  EXPECT_EQ(out("out.vdb").facts().kept_isovalue, 150);
  EXPECT_THAT(run({"info", "out.vdb"}).out, HasSubstr("surface      at isovalue 150, which the file keeps"));
  expectSuccess(run({"recover", "journal", "--out", "back.vdb"}));
  EXPECT_EQ(out("back.vdb").facts().kept_isovalue, 150);
  expectSuccess(run(Words{"edit", "out.vdb", "next.nrrd", "--json", "result.json"} + drill));
  EXPECT_EQ(json()["isovalue"], 150);
  EXPECT_FALSE(out("next.nrrd").facts().kept_isovalue);
  expectSuccess(run(Words{"edit", "out.vdb", "next.vdb", "--iso", "160"} + drill));
  EXPECT_EQ(out("next.vdb").facts().kept_isovalue, 160);
  expectSuccess(run({"convert", "out.vdb", "kept.stl"}));
  expectSuccess(run({"convert", "out.vdb", "asked.stl", "--iso", "150"}));
  EXPECT_EQ(contentsOf(file("kept.stl")).substr(80), contentsOf(file("asked.stl")).substr(80));
  for (const auto& [filter, isovalue] : {std::pair("gaussian:1mm", 150), std::pair("distance:3", 0)}) {
    expectSuccess(run({"filter", "out.vdb", "--out", "filtered.vdb", "--filter", filter}));
    EXPECT_EQ(out("filtered.vdb").facts().kept_isovalue, isovalue) << filter;
  }
}

TEST_F(EditVerb, RecoverSaysWhatItMayBeGiven) {
  expectSuccess(run({"convert", kVolume, "in.vdb"}));
  expectSuccess(run(Words{"edit", "in.vdb", "out.nrrd", "--iso", "0", "--journal", "journal"} +
                    dos({"remove:radius=5:at=6,0,0"})));
  // The file instead of its folder.
  const Outcome recovered = run({"recover", "journal/journal.palpate", "--out", "back.nrrd"});
  expectSuccess(recovered);
  EXPECT_THAT(recovered.out, HasSubstr("Journal   1 edit, 0 undone; newest record 1\n"));
  EXPECT_EQ(contentsOf(file("back.nrrd")), contentsOf(file("out.nrrd")));
  expectRefusal(run({"recover", "in.vdb", "--out", "a.nrrd"}), "in.vdb",
                "it is no journal of Palpate; name the folder that", 2);
  expectRefusal(run({"recover", "none", "--out", "a.nrrd"}), "none", "there is no such folder", 3);
  expectRefusal(run({"recover", ".", "--out", "a.nrrd"}), ".", "there is no journal.palpate in it", 3);
  expectRefusal(run({"recover", "journal", "--out", "a.nrrd", "--volume", ""}), "--volume", "'' is empty", 2);
  // The volume has moved, or another lies there now.
  std::filesystem::rename(file("in.vdb"), file("moved.vdb"));
  const Outcome moved = run({"recover", "journal", "--out", "a.nrrd"});
  expectRefusal(moved, "in.vdb", "no such file", 3);
  EXPECT_THAT(moved.err, HasSubstr("if that has moved, say where it lies now with --volume"));
  EXPECT_EQ(contentIn(run({"recover", "journal", "--out", "a.nrrd", "--volume", "moved.vdb"}).out),
            contentIn(recovered.out));
  expectSuccess(run({"convert", "phantom:box?size=32", "in.vdb"}));
  expectRefusal(run({"recover", "journal", "--out", "b.nrrd"}), "in.vdb", "give that volume with --volume", 2);
}

// A flag takes one command, so volumes may come behind it.
TEST_F(EditVerb, FlagsMayComeFirst) {
  expectSuccess(run(Words{"edit"} + dos({"remove:radius=5:at=6,0,0", "undo"}) + Words{kVolume, "out.nrrd"}));
  expectRefusal(edit(dos({"remove:radius=5:at=6,0,0"}) + Words{"undo"}), "undo", "not expected", 2);
}

TEST_F(EditVerb, WritesAMeshOfWhatItEdited) {
  expectSuccess(run(Words{"edit", kVolume, "out.stl"} + dos({"remove:radius=5:at=6,0,0"})));
  expectSuccess(edit(dos({"remove:radius=5:at=6,0,0"})));
  expectSuccess(run({"convert", "out.nrrd", "direct.stl", "--iso", "0"}));
  EXPECT_EQ(contentsOf(file("out.stl")).substr(80), contentsOf(file("direct.stl")).substr(80));
}

// Of a body that was cut, stamped and dented all over, so that it ends at the border too: what is not closed, a stamp
// refuses.
TEST_F(EditVerb, WritesAClosedMesh) {
  for (const std::string mesh : {"out.stl", "out.obj", "out.ply"}) {
    if (mesh == "out.obj" && !isLongRun()) continue;  // shares its corners, as a .ply does
    expectSuccess(
        run(Words{"edit", kVolume, mesh} +
            dos({"add:radius=5:at=13,0,0", "remove:radius=4:from=-9,-9,-9:to=9,9,9", "inflate:radius=6:at=0,6,0",
                 "cut:point=0,-6,0:normal=0.2,-1,0.1", "smooth:radius=8:at=6,0,0", "add:radius=0.6:at=0,0,0"})));
    expectSuccess(edit(dos({fmt::format("stamp-add:mesh={}:at=0,0,0", mesh)})));
  }
}

TEST_F(EditVerb, TheResultForPrograms) {
  expectSuccess(edit(dos({"remove:radius=5:at=6,0,0", "remove:radius=5:at=0,6,0", "undo"}) +
                     Words{"--json", "result.json", "--history", "1MiB", "--journal", "journal"}));
  EXPECT_EQ(json()["commands"]["edits"], 2);
  EXPECT_EQ(json()["commands"]["undone"], 1);
  EXPECT_EQ(json()["commands"]["refused"], 0);
  EXPECT_EQ(json()["journal"]["saved"], 3);
  EXPECT_EQ(json()["history"]["steps"], 2);
  EXPECT_GT(json()["command_ms"]["p50"], 0);
  EXPECT_GE(json()["changed_bricks"], 8);
  EXPECT_LE(json()["changed_bricks"], 64);
  EXPECT_GT(json()["gpu_budgeted_bytes"], 0);
  EXPECT_LT(json()["gpu_budgeted_bytes"], json()["gpu_bytes"]);
  EXPECT_EQ(json()["content"], fmt::format("{:016x}", contentHash(out())));
}

// What is read is never replaced: not the script, not a stamp's mesh, even where its edit is refused and left out.
TEST_F(EditVerb, NeverReplacesAStampOrAScript) {
  expectSuccess(run({"convert", "phantom:sphere?size=16&spacing=0.5mm", "ball.stl"}));
  write("script.txt", "remove:radius=2:at=6,0,0\n");
  const std::string mesh = contentsOf(file("ball.stl"));
  const std::string script = contentsOf(file("script.txt"));
  const Words stamp = dos({"stamp-add:mesh=ball.stl:at=6,0,0"});
  const Words far_stamp = dos({"stamp-add:mesh=ball.stl:at=900,0,0", "remove:radius=2:at=6,0,0"});
  for (const Words& words :
       {Words{"edit", kVolume, "ball.stl"} + stamp, Words{"edit", kVolume, "out.nrrd", "--json", "ball.stl"} + stamp,
        Words{"edit", kVolume, "ball.stl", "--keep-going"} + far_stamp}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("it is the input"));
  }
  for (const Words& words : {Words{"edit", kVolume, "out.nrrd", "--script", "script.txt", "--json", "script.txt"},
                             Words{"edit", kVolume, "copy.nrrd", "--script", "copy.nrrd"}}) {
    if (words.back() == "copy.nrrd") write("copy.nrrd", script);
    expectRefusal(run(words), words.back(), "it is the input", 2);
  }
  EXPECT_EQ(contentsOf(file("ball.stl")), mesh);
  EXPECT_EQ(contentsOf(file("script.txt")), script);
  EXPECT_EQ(contentsOf(file("copy.nrrd")), script);
  EXPECT_FALSE(exists("out.nrrd"));
}

// Most likely a slip of the unit or the place.
TEST_F(EditVerb, TellsOfEditsThatChangeNothing) {
  const Outcome outcome =
      edit(dos({"remove:radius=2:at=14,14,14", "remove:radius=2:at=6,0,0"}) + Words{"--json", "result.json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(errorLines(outcome.err), testing::ElementsAre(HasSubstr("at=14,14,14': it changed nothing")));
  EXPECT_THAT(outcome.out, HasSubstr("0 refused; 1 changed nothing\n"));
  EXPECT_EQ(json()["commands"]["changed_nothing"], 1);
  Words many;
  for (int i = 0; i < 14; ++i) many = many + dos({"remove:radius=2:at=14,14,14"});
  EXPECT_EQ(errorLines(edit(many).err).size(), 10U);
}

// A unit that was meant to be another one, most likely; told once.
TEST_F(EditVerb, TellsOfABrushThatVoxelsCannotShow) {
  const Outcome outcome =
      edit(dos({"remove:radius=1um:at=9.7,0,0", "remove:radius=2um:at=9,0,0", "remove:radius=0.5:at=9,0,0"}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(errorLines(outcome.err),
              testing::ElementsAre(
                  HasSubstr("radius=1um:at=9.7,0,0': its radius of 0.001 mm is below half a voxel (of 1 mm)")));
}

// A file that cannot keep the isovalue would silently have another surface.
TEST_F(EditVerb, TellsOfAnIsovalueThatTheFileCannotKeep) {
  const Words drill = dos({"remove:radius=2:at=6,0,0"});
  EXPECT_THAT(edit(drill + Words{"--iso", "150"}).out,
              HasSubstr("at 150, which this format cannot keep: give --iso 150"));
  EXPECT_THAT(run(Words{"edit", kVolume, "out.vdb", "--iso", "150", "--journal", "journal"} + drill).out,
              HasSubstr("at 150, which the file keeps"));
  EXPECT_THAT(run({"recover", "journal", "--out", "again.nii"}).out,
              HasSubstr("at 150, which this format cannot keep"));
}

// Hundreds of commands, in a long run thousands, down a pipe.
TEST_F(EditVerb, StandardInputMayBeLong) {
  const int commands = isLongRun() ? 2000 : 600;
  std::string script = "\xEF\xBB\xBF# a comment\r\n\n";
  for (int i = 0; i < commands; ++i) {
    script += i % 10 == 9 ? "undo # the last\r\n"
                          : fmt::format("  {}:radius=1.5mm:at={:.1f},{:.1f},{:.1f}\n", i % 2 == 0 ? "remove" : "add",
                                        9 * std::sin(i), 9 * std::cos(i), 9 * std::sin(0.37 * i));
  }
  write("script", script.substr(0, script.size() - 2));  // the last line needs no end
  const Outcome outcome =
      runPalpate({.arguments = {"edit", kVolume, "out.nrrd", "--script", "-", "--journal", "journal"},
                  .folder = folder(),
                  .input_file = file("script").string()});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("{} applied: {} edits, {} undos, 0 redos; 0 refused", commands,
                                                 commands - commands / 10, commands / 10)));
  const Outcome recovered = run({"recover", "journal", "--out", "back.nrrd"});
  EXPECT_EQ(contentIn(recovered.out), contentIn(outcome.out));
  // The same from a file, behind commands of the command line.
  const Outcome again = edit(dos({"remove:radius=2:at=0,0,0", "undo"}) + Words{"--script", "script"});
  expectSuccess(again);
  EXPECT_EQ(contentIn(again.out), contentIn(outcome.out));
}

// A script's meshes lie beside it.
TEST_F(EditVerb, AScriptsFilesStartAtItsFolder) {
  std::filesystem::create_directory(file("scripts"));
  write("scripts/tet.obj", kMesh);
  write("scripts/a.txt", "stamp-add:mesh=tet.obj:at=8,0,0\nstamp-add:at=0,8,0:mesh=tet.obj # again\n");
  expectSuccess(edit({"--script", "scripts/a.txt"}));
}

TEST_F(EditVerb, AScriptsErrorNamesFileLineAndText) {
  write("a.txt", "# holes\nremove:radius=2mm:at=6,0,0\n\nremove:radius=0mm:at=6,0,0\n");
  const Outcome outcome = edit({"--script", "a.txt", "--journal", "journal"});
  expectRefusal(outcome, "a.txt line 4 'remove:radius=0mm:at=6,0,0'", "'0mm' of radius is no length above 0", 2);
  EXPECT_THAT(outcome.err, HasSubstr("out.nrrd was not written, 1 command had been applied "
                                     "and the journal journal holds them: see 'palpate recover'"));
  expectNothingWritten();
  EXPECT_EQ(readJournal(file("journal")).last_sequence, 1U);
  // The first command at fault: no journal is left that would be in the way of the next try.
  write("b.txt", "undo\n");
  expectRefusal(edit({"--script", "b.txt", "--journal", "other"}), "b.txt line 1", "0 commands had been applied", 2);
  expectSuccess(edit(dos({"remove:radius=2mm:at=6,0,0"}) + Words{"--journal", "other"}));
  std::filesystem::remove(file("out.nrrd"));
  // A line without end.
  write("c.txt", "remove:radius=2mm:at=6,0,0\nremove:" + std::string(1'000'000, '1') + "\n");
  expectRefusal(edit({"--script", "c.txt"}), "c.txt line 2", "more than 8192 bytes", 2);
}

TEST_F(EditVerb, AScriptThatIsNoTextIsRefusedAndSaysWhy) {
  write("script", std::string("remove:radius=2:at=6,0,0\n\x7f"
                              "ELF\x02\x01\x00\x01",
                              33));
  expectRefusal(edit({"--script", "script"}), "script line 2", "it is no text: byte 1 is 0x7f; give commands as text",
                2);
  write("zero", std::string("remove:radius=2\0:at=6,0,0", 25));
  expectRefusal(edit({"--script", "zero"}), "zero line 1", "it is no text: byte 16 is 0x00", 2);
  expectNothingWritten();
}

// A program may write an empty script: the volume as it was, and a word about it.
TEST_F(EditVerb, AScriptWithoutACommandIsToldAndCopies) {
  write("empty.txt", "# nothing today\n\n");
  const Outcome outcome = edit({"--script", "empty.txt"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err,
              HasSubstr("palpate: empty.txt: "
                        "it has no command, so there was nothing to do; out.nrrd holds the volume as it was\n"));
  EXPECT_EQ(contentHash(out()), contentHash(loadVolume(kVolume)));
  EXPECT_THAT(edit(dos({"remove:radius=2:at=6,0,0"})).err, Not(HasSubstr("nothing to do")));
}

TEST_F(EditVerb, KeepGoingTellsAndLeavesOut) {
  const Outcome outcome = edit(dos({"carve:radius=2", "remove:radius=2:at=6,0,0", "undo", "undo", "redo",
                                    "stamp-add:mesh=none.obj:at=0,0,0", "remove:radius=9m:at=0,0,0"}) +
                               Words{"--keep-going"});
  EXPECT_EQ(outcome.status, 0);
  const Words told = errorLines(outcome.err);
  ASSERT_EQ(told.size(), 4U) << outcome.err;
  for (const std::string& line : told) EXPECT_THAT(line, testing::ContainsRegex("^palpate: --do '.*; .* .left out.$"));
  EXPECT_THAT(outcome.out, HasSubstr("3 applied: 1 edit, 1 undo, 1 redo; 4 refused"));
  EXPECT_EQ(contentIn(outcome.out), contentIn(edit(dos({"remove:radius=2:at=6,0,0"})).out));
}

// The brush is right as text, but not for this volume or this session; OUT is not there afterwards.
TEST_F(EditVerb, RefusesWhatTheSessionRefuses) {
  write("open.obj", kOpenMesh);
  write("not.obj", "no mesh");
  const std::tuple<const char*, const char*, int> cases[] = {
      {"remove:radius=9m:at=0,0,0", "larger than the volume; give at most", 2},
      {"remove:radius=2:at=0,0,1e300", "away from the volume", 2},
      {"cut:point=0,0,5m:normal=0,0,1", "mm away from the volume", 2},
      {"cut:point=0,0,0:normal=1e300,1e300,0", "has no direction", 2},
      {"add:radius=2:at=0,0,0:density=-5", "not above the isovalue", 2},
      {"stamp-add:mesh=none.obj:at=0,0,0", "there is no such file", 3},
      {"stamp-add:mesh=not.obj:at=0,0,0", "cannot be read", 2},
      {"stamp-add:mesh=open.obj:at=0,0,0", "the mesh is not closed", 2},
      {"redo", "nothing was undone", 2},
      {"remove:radius=2", "it has no place", 2},
      {"remove:radius=nan:at=0,0,0", "is no number", 2},
  };
  const std::tuple<const char*, const char*, int> like_those[] = {
      {"remove:radius=1e300:at=0,0,0", "larger than the volume", 2},
      {"remove:radius=2:at=0,0,5m", "mm away from the volume", 2},
      {"undo", "there is no edit to undo", 2},  // as below
  };
  const auto expectRefused = [&](const std::tuple<const char*, const char*, int>& one) {
    const auto& [command, reason, status] = one;
    expectRefusal(edit(dos({command})), fmt::format("--do '{}'", command), reason, status);
    expectNothingWritten();
  };
  for (const auto& one : cases) expectRefused(one);
  for (const auto& one : like_those) {
    if (isLongRun()) expectRefused(one);
  }
  expectRefusal(edit(dos({"remove:radius=2:at=6,0,0", "undo"}) + Words{"--history", "0"}), "--do 'undo'",
                "there is no edit to undo", 2);
}

TEST_F(EditVerb, RefusesArgumentsThatCannotBeMeant) {
  const Words drill = dos({"remove:radius=2:at=6,0,0"});
  expectSuccess(run(Words{"edit", kVolume, "in.nrrd"} + drill));
  const std::string before = contentsOf(file("in.nrrd"));
  expectRefusal(run(Words{"edit", "in.nrrd", "in.nrrd"} + drill), "in.nrrd", "it is the input", 2);
  expectRefusal(run(Words{"edit", "in.nrrd", "out.nrrd", "--json", "in.nrrd"} + drill), "in.nrrd", "it is the input",
                2);
  EXPECT_EQ(contentsOf(file("in.nrrd")), before);
  expectRefusal(edit(drill + Words{"--json", "out.nrrd"}), "--json out.nrrd", "it is the output", 2);
  const Outcome no_folder = edit(drill + Words{"--json", "none/a.json"});
  expectRefusal(no_folder, "none/a.json", "cannot be created", 4);
  EXPECT_THAT(no_folder.err, Not(HasSubstr("loading")));
  expectRefusal(edit({}), "palpate edit", "nothing to do", 2);
  expectRefusal(edit(dos({""})), "--do ''", "there is no edit ''", 2);
  for (const char* flag : {"--script", "--journal", "--json"})
    expectRefusal(edit(drill + Words{flag, ""}), flag, "'' is empty", 2);
  expectRefusal(edit({"--script", "none.txt"}), "none.txt", "there is no such script", 3);
  expectRefusal(edit({"--script", "."}), ".", "it is a folder", 2);
  expectRefusal(edit(drill + Words{"--history", "much"}), "--history", "'much' is no size of memory", 2);
  expectRefusal(edit(drill + Words{"--gpu-memory", "-1"}), "--gpu-memory", "'-1' is no size of memory", 2);
  expectRefusal(edit(drill + Words{"--iso", "4000"}), "phantom:sphere", "isovalue", 2);
  expectRefusal(run(Words{"edit", "none.nrrd", "out.nrrd"} + drill), "none.nrrd", "no such file", 3);
  expectRefusal(run(Words{"edit", kVolume, "out.tiff"} + drill), "out.tiff", "names no format", 2);
  expectRefusal(run(Words{"edit", kVolume, "no/out.vdb"} + drill), "no/out.vdb", "cannot be created", 4);
  expectNothingWritten();
}

// 512 bricks, of which the sphere's take some 2 MiB with room to spare; painting all of the air needs all of them.
TEST_F(EditVerb, ReachingTheGpuBudgetIsClearAndSurvivable) {
  const Words words = {"edit", "phantom:sphere?size=64", "out.nrrd"};
  const Outcome nothing_fits = run(words + dos({"undo"}) + Words{"--gpu-memory", "100KiB"});
  expectRefusal(nothing_fits, "GPU memory for the volume", "samples at its surface come on top", 5);
  EXPECT_THAT(nothing_fits.err, HasSubstr("the budget is 0.1 MiB; raise --gpu-memory"));
  EXPECT_THAT(nothing_fits.err, Not(HasSubstr("brush")));
  const Outcome samples_do_not = run(words + dos({"undo"}) + Words{"--gpu-memory", "1MiB"});
  expectRefusal(samples_do_not, "GPU memory for the volume", "for samples at its surface), and the budget is 1.0 MiB",
                5);
  EXPECT_THAT(samples_do_not.err, HasSubstr("raise --gpu-memory to "));
  const Words flood = dos({"remove:radius=3:at=18,0,0", "paint:radius=50:at=0,0,0:falloff=1:value=100", "undo"});
  const Outcome refused = run(words + flood + Words{"--gpu-memory", "4MiB"});
  expectRefusal(refused, "--do 'paint:", "GPU memory for", 5);
  EXPECT_THAT(refused.err, HasSubstr("1 command had been applied"));
  EXPECT_THAT(refused.err, HasSubstr("the volume, as edited until now, takes "));
  expectNothingWritten();
  const Outcome went_on = run(words + flood + Words{"--gpu-memory", "4MiB", "--keep-going"});
  EXPECT_EQ(went_on.status, 0) << went_on.err;
  EXPECT_THAT(went_on.out, HasSubstr("2 applied: 1 edit, 1 undo, 0 redos; 1 refused"));
  EXPECT_EQ(contentIn(went_on.out), fmt::format("{:016x}", contentHash(loadVolume("phantom:sphere?size=64"))));
  // What is held against the budget, and that there is more; the brush was taken back, so nothing changed.
  EXPECT_THAT(went_on.out, MatchesRegex("(.|\n)*Changed   0 bricks\n"
                                        "Memory    [0-9.]+ MiB of 4 MiB on the GPU for densities and samples, "
                                        "[0-9.]+ MiB with all else; (.|\n)*"));
  expectSuccess(run(words + flood + Words{"--gpu-memory", "1GiB"}));
}

// A full disk, stood for by a limit on the size of files: the journal ends, the edits and the file do not.
TEST_F(EditVerb, AFullDiskUnderTheJournalIsToldAndSurvived) {
  std::string script;
  for (int i = 0; i < 3000; ++i) script += fmt::format("remove:radius=2:at={:.2f},0,0\n", 9 * std::sin(i));
  write("script", script);
  const Outcome outcome =
      runPalpate({.arguments = {"edit", kVolume, "out.nii.gz", "--script", "script", "--journal", "j"},
                  .folder = folder(),
                  .file_size_limit = 100'000});
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  const Words told = errorLines(outcome.err);
  ASSERT_EQ(told.size(), 1U) << outcome.err;
  EXPECT_THAT(told[0], HasSubstr("are not saved: make room"));
  EXPECT_THAT(outcome.out, HasSubstr("3000 applied"));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("3000 of 3000 records")));
}

// A pipe that stays open: a refused command and Ctrl-C both end the run, and nobody waits for the pipe.
TEST_F(EditVerb, NobodyWaitsForAPipeThatSaysNothing) {
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  const int pipe = open(file("pipe").c_str(), O_RDWR);
  ASSERT_EQ(::write(pipe, "undo\n", 5), 5);
  expectRefusal(edit({"--script", "pipe"}), "pipe line 1 'undo'", "there is no edit to undo", 2);
  ASSERT_EQ(::write(pipe, "remove:radius=2:at=6,0,0\n", 25), 25);
  const Outcome stopped =
      runPalpate({.arguments = {"edit", kVolume, "out.nrrd", "--script", "pipe", "--journal", "journal"},
                  .folder = folder(),
                  .signal_at = "applying the edits",
                  .signals = {SIGINT}});
  expectRefusal(stopped, "palpate edit", "stopped by the user", 130);
  close(pipe);
  expectNothingWritten();
}

TEST_F(EditVerb, CommandsIsTheDocumentedTable) {
  const Outcome outcome = run({"edit", "--commands"});
  expectSuccess(outcome);
  EXPECT_EQ(outcome.out, editTextTable());
  EXPECT_THAT(contentsOf(PALPATE_DOCS "/edits.md"), HasSubstr(outcome.out));
}

}  // namespace edit_verb_test
}  // namespace palpate
