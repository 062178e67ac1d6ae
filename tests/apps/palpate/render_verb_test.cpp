// SPDX-License-Identifier: Apache-2.0
// `palpate render` as its users run it. What is in the files: tests/apps/render/render_job_test.cpp.
#include <cmath>
#include <cstdint>
#include <cstring>

#include <nlohmann/json.hpp>

#include "nrrd_bytes.hpp"
#include "program_test.hpp"

namespace palpate {
namespace render_verb_test {

using testing::HasSubstr;

const std::string kSphere = "phantom:sphere?size=32";

class RenderVerb : public ProgramTest {
 protected:
  [[nodiscard]] Outcome render(const Words& more) const { return run(Words{"render", kSphere, "-o", "o.png"} + more); }
  // Width and height of a PNG, of which its first part (IHDR) begins at byte 16.
  [[nodiscard]] std::pair<unsigned, unsigned> sizeOf(const std::string& name) const {
    const std::string bytes = contentsOf(file(name));
    EXPECT_TRUE(bytes.starts_with("\x89PNG\r\n"));
    const auto number = [&](std::size_t at) {
      unsigned value = 0;
      for (std::size_t i = at; i < at + 4 && i < bytes.size(); ++i)
        value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
      return value;
    };
    return {number(16), number(20)};
  }
  [[nodiscard]] float middleOfPfm(const std::string& name, std::size_t side) const {
    const std::string bytes = contentsOf(file(name));
    const std::size_t header = bytes.size() - 4 * side * side;
    float value = 0;
    if (header < bytes.size()) std::memcpy(&value, &bytes[header + 4 * (side * (side / 2) + side / 2)], 4);
    return value;
  }
};

// The sphere's radius is 0.7 of 15.5 mm. 0.05 mm: ten times what interpolation may do to its surface.
TEST_F(RenderVerb, WritesAPictureItsDepthAndACamera) {
  const Outcome outcome = render({"--size", "33x33", "--distance", "60", "--target", "0,0,0", "--depth", "o.pfm",
                                  "--json", "o.json", "--iso", "0"});
  expectSuccess(outcome);
  EXPECT_EQ(sizeOf("o.png"), std::pair(33U, 33U));
  EXPECT_NEAR(middleOfPfm("o.pfm", 33), 0.06 - 0.7 * 0.0155, 5e-5);
  const auto json = nlohmann::json::parse(contentsOf(file("o.json")));
  EXPECT_EQ(json["schema"], "palpate.render/1");
  EXPECT_EQ(json["pictures"][0]["depth"], "o.pfm");
  const auto position = json["pictures"][0]["camera"]["position_m"];
  EXPECT_NEAR(position[1].get<double>(), -0.06, 1e-12);
  EXPECT_THAT(outcome.out, HasSubstr("Drew      " + kSphere + " (32 x 32 x 32 voxels) at isovalue 0 on "));
  EXPECT_THAT(outcome.out, HasSubstr("Picture   33 x 33 pixels; "));
  EXPECT_THAT(outcome.out, HasSubstr("Extent    -15.5,-15.5,-15.5 to 15.5,15.5,15.5 mm\n"));
  EXPECT_THAT(outcome.out, HasSubstr("JSON      o.json\n"));
  EXPECT_NEAR(json["extent_m"][1][2].get<double>(), 0.0155, 1e-12);
  EXPECT_THAT(outcome.out, HasSubstr("File      o.png, "));
  EXPECT_THAT(outcome.out, HasSubstr("Depth     o.pfm, "));
}

TEST_F(RenderVerb, WritesAFileForEachFrameOfATurn) {
  expectSuccess(render({"--size", "16x16", "--frames", "3", "--depth", "d.pfm"}));
  for (const char* name : {"o_000.png", "o_001.png", "o_002.png", "d_000.pfm", "d_002.pfm"})
    EXPECT_TRUE(exists(name)) << name;
  EXPECT_FALSE(exists("o.png"));
  EXPECT_FALSE(exists("o_003.png"));
}

// The first half of the sphere is in front of the plane; a plane's side may begin with a dash, as a flag does.
TEST_F(RenderVerb, TakesPlanesAsOftenAsWanted) {
  const Words view = {"--size", "33x33", "--distance", "60", "--target", "0,0,0", "--depth", "o.pfm"};
  expectSuccess(render(view + Words{"--clip", "y=0", "--clip", "-x=5", "--slice", "0,0,1@-3", "--slice", "x=-4"}));
  EXPECT_NEAR(middleOfPfm("o.pfm", 33), 0.06, 1e-6);
  expectSuccess(render(view + Words{"--clip=-y=0"}));
  EXPECT_LT(middleOfPfm("o.pfm", 33), 0.06F - 0.01F);
  expectSuccess(run(Words{"render", "-o", "p.png", "--clip", "-x=5", kSphere, "--size", "8x8"}));  // volume behind it
}

TEST_F(RenderVerb, ASecondSurfaceIsInThePictureAndNotInTheDepth) {
  expectSuccess(render({"--size", "16x16", "--depth", "a.pfm"}));
  const std::string picture = contentsOf(file("o.png"));
  const Outcome outcome = render({"--size", "16x16", "--depth", "b.pfm", "--second", "-1", "--second-opacity", "1"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("Second    isovalue -1, opacity 1"));
  EXPECT_NE(contentsOf(file("o.png")), picture);
  EXPECT_EQ(contentsOf(file("a.pfm")), contentsOf(file("b.pfm")));
}

TEST_F(RenderVerb, TellsWhereNothingIsSeen) {
  const Outcome outcome = render({"--size", "16x16", "--target", "500,0,0", "--distance", "50"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("nothing is seen"));
  EXPECT_THAT(outcome.out, HasSubstr("the volume reaches from -15.5,-15.5,-15.5 to 15.5,15.5,15.5 mm"));
}

// The volume is from -15.5 to 15.5 mm, so that a quarter is at -7.75 mm; the sphere begins at -10.85 mm.
TEST_F(RenderVerb, TakesPlanesAtSharesOfTheVolume) {
  const Words view = {"--size", "33x33", "--distance", "60", "--target", "0,0,0", "--depth", "o.pfm"};
  expectSuccess(render(view + Words{"--clip", "y=50%", "--slice", "y=50%"}));
  EXPECT_NEAR(middleOfPfm("o.pfm", 33), 0.06, 1e-6);
  expectSuccess(render(view + Words{"--clip", "-y=25%"}));
  const float front = middleOfPfm("o.pfm", 33);
  expectSuccess(render(view));
  EXPECT_EQ(middleOfPfm("o.pfm", 33), front);
  expectSuccess(render(view + Words{"--clip", "0,1,0@25%"}));
  EXPECT_NEAR(middleOfPfm("o.pfm", 33), 0.06 - 0.00775, 1e-6);
}

TEST_F(RenderVerb, RefusesWhatItDoesNotTake) {
  struct Case {
    Words more;
    const char* input;
    const char* reason;
    int status = 2;
  };
  const Case cases[] = {{{"--size", "0x9"}, "--size", "'0x9' is not what it takes"},
                        {{"--view", "side"}, "--view", "give front, back, left, right, top, bottom"},
                        {{"--view", "left", "--view", "back"}, "--view", "more than once"},
                        {{"--view", "left", "--from", "0,0"}, "--from", "--view is given too"},
                        {{"--clip", "x>3"}, "--clip", "'x>3'"},
                        {{"--second-opacity", "0.2"}, "--second-opacity", "no effect without --second"},
                        {{"--second", "1e6"}, "--second", "is not below that of the first surface"},
                        {{"--second", "-1e6"}, "--second", "gives no surface"},
                        {{"--second", "-1", "--normals"}, "--normals", "--second is given too"},
                        {{"--slice", "x=0", "--normals"}, "--normals", "--slice is given too"},
                        {{"--slice", "x=16"}, "--slice", "'x=16' lies beside the volume"},
                        {{"--clip", "x=16"}, "--clip", "nothing is left of the volume"},
                        {{"--iso", "1e6"}, kSphere.c_str(), "isovalue 1e+06"},
                        {{"--frames", "0"}, "--frames", "a whole number from 1 to 3600"},
                        {{"--filter", "mean:1"}, "mean", "there is no"},
                        {{"--depth", "o.exr"}, "o.exr", "written as .pfm only"},
                        {{"--depth", ""}, "--depth", "'' is empty"},
                        {{"--json", "o.png"}, "o.png", "two of the outputs"},
                        {{"--json", "none/o.json"}, "none/o.json", "cannot be created", 4},
                        {{"--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
                        {{"--gpu-memory", "4kB"}, "density", "", 5},
                        {{"--zom", "2"}, "--zom", "did you mean --zoom?"}};
  for (const Case& one : cases) expectRefusal(render(one.more), one.input, one.reason, one.status);
  expectRefusal(run({"render", kSphere}), "--out", "required", 2);
  expectRefusal(run({"render", kSphere, "-o", "o.jpg"}), "o.jpg", "written as .png only", 2);
  expectRefusal(run({"render", "none.nrrd", "-o", "o.png"}), "none.nrrd", "no such file", 3);
  EXPECT_TRUE(std::filesystem::is_empty(folder()));
}

// Before the volume is read, which is not there.
TEST_F(RenderVerb, TriesAllItsFilesAtOnce) {
  std::filesystem::create_directory(file("o_017.png"));
  std::filesystem::create_directory(file("d_018.pfm"));
  expectRefusal(run({"render", "none.nrrd", "-o", "o.png", "--frames", "18"}), "o_017.png", "it is not a plain file",
                4);
  expectRefusal(run({"render", "none.nrrd", "-o", "p.png", "--depth", "d.pfm", "--frames", "19"}), "d_018.pfm",
                "it is not a plain file", 4);
  expectRefusal(run({"render", "none.nrrd", "-o", "o.png", "--frames", "17"}), "none.nrrd", "no such file", 3);
}

TEST_F(RenderVerb, HelpNamesWhatEachOptionTakes) {
  const std::string help = run({"help", "render"}).out;
  for (const char* words : {"--distance MM ", "--fov DEG ", "--target X,Y,Z ", "--clip PLANE ", "--iso DENSITY "})
    EXPECT_THAT(help, HasSubstr(words));
  EXPECT_THAT(help, testing::Not(HasSubstr("e+38")));
}

TEST_F(RenderVerb, NeverReplacesItsInput) {
  const std::string scan = ballNrrd().bytes();
  write("scan.nrrd", scan);
  std::filesystem::create_symlink(file("scan.nrrd"), file("o.png"));
  std::filesystem::create_symlink(file("scan.nrrd"), file("o.pfm"));
  expectRefusal(run({"render", "scan.nrrd", "-o", "o.png"}), "o.png", "it is the input", 2);
  expectRefusal(run({"render", "scan.nrrd", "-o", "p.png", "--depth", "o.pfm"}), "o.pfm", "it is the input", 2);
  expectRefusal(run({"render", "scan.nrrd", "-o", "p.png", "--json", "scan.nrrd"}), "scan.nrrd", "it is the input", 2);
  EXPECT_EQ(contentsOf(file("scan.nrrd")), scan);
  EXPECT_FALSE(exists("p.png"));
}

// A disk that gets full at the depth image leaves neither file.
TEST_F(RenderVerb, AFullDiskLeavesNoPicture) {
  const Outcome outcome =
      runPalpate({.arguments = {"render", kSphere, "-o", "o.png", "--depth", "o.pfm", "--size", "64x64"},
                  .folder = folder(),
                  .file_size_limit = 12'000});  // of 16 KiB; the picture is smaller
  expectRefusal(outcome, "o.pfm", "cannot be written", 4);
  EXPECT_TRUE(std::filesystem::is_empty(folder()));
}

}  // namespace render_verb_test
}  // namespace palpate
