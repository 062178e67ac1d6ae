// SPDX-License-Identifier: Apache-2.0
// `palpate info`, and what other verbs say of a volume that is odd.
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "nrrd_bytes.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace info_verb_test {

using testing::HasSubstr;

class InfoVerb : public ProgramTest {};

TEST_F(InfoVerb, InfoSaysWhatAVolumeIs) {
  const Outcome outcome = run({"info", "phantom:sphere?size=24x20x16&spacing=0.5x1x2mm"});
  expectSuccess(outcome);
  for (const char* words :
       {"24 x 20 x 16 voxels", "0.5 x 1 x 2 mm", "phantom", "range", "histogram", "isovalues worth trying"}) {
    EXPECT_THAT(outcome.out, HasSubstr(words));
  }
}

// A turned lattice has its box in the world; the middle is where an edit may begin.
TEST_F(InfoVerb, InfoSaysWhereAVolumeLies) {
  EXPECT_THAT(run({"info", "phantom:sphere?size=25x21x17&spacing=0.5x1x2mm"}).out,
              HasSubstr("places       x -6 to 6, y -10 to 10, z -16 to 16 mm; the middle 0,0,0\n"));
}

// A turned lattice with three spacings, worked out by hand: its axes are (2,3,6), (6,2,-3) and (3,-6,2) sevenths, with
// 7, 3.5 and 14 mm between voxels. Of 60 voxels 40 hold 0, 15 hold 12.5 and 5 hold 24, so bins are 1 wide and bars
// ln 41, ln 16 and ln 6 over ln 41 of 50 letters long.
TEST_F(InfoVerb, InfoOfATurnedVolume) {
  std::vector<float> values(40, 0.0F);
  values.resize(55, 12.5F);
  values.resize(60, 24.0F);
  write("a.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 3 4 5\nspace: left-posterior-superior\n"
        "space directions: (2,3,6) (3,1,-1.5) (6,-12,4)\nspace origin: (10,20,-30)\nencoding: raw\nendian: little\n\n" +
            std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
  const std::string info = run({"info", "a.nrrd"}).out;
  EXPECT_THAT(info, testing::StartsWith(R"(a.nrrd
  format       NRRD (float32)
  size         3 x 4 x 5 voxels
  spacing      7 x 3.5 x 14 mm
  extent       21 x 14 x 70 mm
  origin       10, 20, -30 mm (LPS)
  places       x 10 to 47, y -28 to 29, z -34.5 to -2 mm; the middle 28.5,0.5,-18.25
  axes         i (0.2857, 0.4286, 0.8571)  j (0.8571, 0.2857, -0.4286)  k (0.4286, -0.8571, 0.2857)
)"));
  EXPECT_THAT(info, HasSubstr("\n  bricks       1 of 1 hold more than one value; "));
  EXPECT_THAT(info,
              HasSubstr("\n  range        0 ... 24, mean 5.125\n  no data?     66.7 % of the voxels hold 0, far "));
  std::string histogram = "  histogram (length of a bar: logarithm of the voxel count)\n";
  for (int bin = 0; bin < 24; ++bin) {
    const std::string bar(bin == 0 ? 50 : bin == 12 ? 37 : bin == 23 ? 24 : 0, '#');
    const int count = bin == 0 ? 40 : bin == 12 ? 15 : bin == 23 ? 5 : 0;
    histogram += fmt::format("  {:>12}  {:<50}  {}\n", bin, bar, count);
  }
  EXPECT_THAT(info, HasSubstr(histogram + "  isovalues worth trying (--iso), the default first\n"));
  EXPECT_THAT(info, testing::Not(HasSubstr("rescale")));
  EXPECT_THAT(info, testing::Not(HasSubstr("  part ")));
  EXPECT_THAT(info, testing::Not(HasSubstr("  note ")));
}

// Coordinates of a file in RAS are turned to LPS, which makes of its origin at 0 one at -0.
TEST_F(InfoVerb, InfoHasNoMinusBeforeAZero) {
  write("a.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nspace: right-anterior-superior\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: ascii\n\n0 1 2 3 4 5 6 7\n");
  const Outcome outcome = run({"info", "a.nrrd"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("origin       0, 0, 0 mm (LPS)"));
  EXPECT_THAT(outcome.out, HasSubstr("places       x -1 to 0, y -1 to 0, z 0 to 1 mm"));
  EXPECT_THAT(outcome.out, HasSubstr("axes         i (-1, 0, 0)  j (0, -1, 0)"));
}

TEST_F(InfoVerb, InfoOfAConstantVolumeStillInforms) {
  const Outcome outcome = run({"info", "phantom:sphere?size=2"});  // eight voxels at one distance from the centre
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("no surface"));
}

// Programs and pages say the same words of a mask, and none of what was smoothed as they advise.
TEST_F(InfoVerb, SayThatAMaskIsFeltAsStairs) {
  NrrdBytes mask = ballNrrd();
  for (float& value : mask.values) value = value > 0 ? 1 : 0;
  write("mask.nrrd", mask.bytes());
  const Outcome info = run({"info", "mask.nrrd"});
  expectSuccess(info);
  EXPECT_THAT(info.out, HasSubstr("few values   it holds 2 values (0, 1), so its surface is felt as stairs"));
  const std::string told = "palpate: mask.nrrd: it holds 2 values (0, 1), so its surface is felt as stairs";
  EXPECT_THAT(run(quickTouch("mask.nrrd")).err, HasSubstr(told));
  EXPECT_THAT(run(quickTouch("mask.nrrd", {"--filter", "gaussian:1.5"})).err, testing::Not(HasSubstr("stairs")));
  expectSuccess(run({"filter", "mask.nrrd", "-o", "smooth.vdb", "--filter", "gaussian:1.5"}));
  EXPECT_THAT(run({"info", "smooth.vdb"}).out, testing::Not(HasSubstr("few values")));
  EXPECT_THAT(run({"info", "phantom:sphere?size=24"}).out, testing::Not(HasSubstr("few values")));
}

// A ramp of floats, two of which are no numbers.
std::string rampWithNan() {
  std::vector<float> values(std::size_t{12} * 12 * 12);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 12);
  values[7] = values[900] = std::numeric_limits<float>::quiet_NaN();
  return "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 12 12\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n" +
         std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

// What is odd about a volume is told once by every verb that loads one.
TEST_F(InfoVerb, TellWhatIsOddAboutAVolume) {
  write("a.nrrd", rampWithNan());
  // Nothing is measured but in a long run; a run is counted all the same.
  const Words plan = Words{"plan", "a.nrrd"} + (isLongRun() ? Words{} : Words{"--rounds", "0"});
  for (const Words& verb :
       {quickTouch("a.nrrd"), plan, Words{"tune", "a.nrrd", "--error", "1N", "--seconds", "0.3"},
        Words{"edit", "a.nrrd", "e.nrrd", "--do", "remove:radius=2:at=0,0,0", "--journal", "journal"},
        Words{"recover", "journal", "--out", "r.nrrd"}, Words{"convert", "a.nrrd", "c.nrrd"},
        Words{"filter", "a.nrrd", "-o", "f.nrrd", "--filter", "median:1"}, Words{"gradient", "a.nrrd", "-o", "g.vdb"},
        Words{"render", "a.nrrd", "-o", "r.png", "--size", "8x8"}, Words{"check", "gradient", "a.nrrd"},
        Words{"check", "filters", "a.nrrd", "--filter", "median:1"}, Words{"check", "edits", "a.nrrd", "--edits", "2"},
        Words{"check", "all", "a.nrrd", "--quick"}}) {
    if (verb[1] == "all" && !isLongRun()) continue;  // half a minute
    const bool has_option = verb[0] != "recover";    // the journal has the name with its option
    const Outcome outcome = run(verb + (has_option ? Words{"--nan", "3"} : Words{}));
    EXPECT_EQ(outcome.status, 0) << verb[0] << ": " << outcome.err;
    const Words lines = errorLines(outcome.err);
    ASSERT_EQ(lines.size(), 1U) << verb[0] << " " << verb[1] << ": " << outcome.err;
    EXPECT_THAT(lines[0], HasSubstr("a.nrrd?nan=3: 2 of ")) << verb[0];
  }
  EXPECT_THAT(run({"info", "a.nrrd", "--nan", "3"}).out, HasSubstr("note         2 of "));
}

// Its own fields, so that a program need not read the words. 2^24 + n is a float for every second n.
TEST_F(InfoVerb, InfoIsAFileToo) {
  std::string bytes;
  for (std::int32_t n = 0; n < 60; ++n) {
    const std::int32_t value = (1 << 24) + n;
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  write("a.nrrd",
        "NRRD0004\ntype: int\ndimension: 3\nsizes: 3 4 5\nspace: left-posterior-superior\n"
        "space directions: (0,2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,-30)\nencoding: raw\nendian: little\n\n" +
            bytes);
  const Outcome outcome = run({"info", "a.nrrd", "--json", "a.json"});
  expectSuccess(outcome);
  const std::string words = "30 of its int32 values are no 32-bit floats and were rounded, by 1 at most";
  EXPECT_THAT(outcome.out, HasSubstr("  rounded      " + words + "\n"));
  const nlohmann::json info = nlohmann::json::parse(std::ifstream(file("a.json")));
  EXPECT_EQ(info.at("schema"), "palpate.info/1");
  EXPECT_EQ(info.at("volume"), "a.nrrd");
  EXPECT_EQ(info.at("format"), "NRRD");
  EXPECT_EQ(info.at("value_type"), "int32");
  EXPECT_EQ(info.at("size_voxel"), nlohmann::json({3, 4, 5}));
  EXPECT_EQ(info.at("spacing_mm"), nlohmann::json({2.0, 3.0, 4.0}));
  EXPECT_EQ(info.at("origin_mm"), nlohmann::json({10.0, 20.0, -30.0}));
  EXPECT_EQ(info.at("axes"), nlohmann::json({{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}));
  EXPECT_EQ(info.at("note"), "");
  EXPECT_EQ(info.at("rounded"), nlohmann::json({{"count", 30}, {"most", 1.0}, {"of", "int32"}}));
  EXPECT_EQ(info.at("replaced"), 0);
  EXPECT_EQ(info.at("resampled"), false);
  EXPECT_EQ(info.at("minimum"), 16777216);
  EXPECT_EQ(info.at("maximum"), 16777276);  // 2^24 + 59, to the even float
  EXPECT_FALSE(info.at("isovalues").empty());
  expectRefusal(run({"info", "a.nrrd", "--json", "a.nrrd"}), "a.nrrd", "it is the input", 2);
  expectRefusal(run({"convert", "a.nrrd", "b.nrrd", "--exact"}), "a.nrrd", words, 2);
  EXPECT_FALSE(exists("b.nrrd"));
  // A name that is no UTF-8: what JSON cannot hold becomes U+FFFD.
  std::filesystem::rename(file("a.nrrd"), file("bad\xff.nrrd"));
  expectSuccess(run({"info", "bad\xff.nrrd", "--json", "a.json"}));
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(file("a.json"))).at("volume"), "bad\uFFFD.nrrd");
  write("a.nrrd", rampWithNan());
  expectSuccess(run({"info", "a.nrrd", "--nan", "3", "--json", "a.json"}));
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(file("a.json"))).at("replaced"), 2);
}

// 64 voxels with so many slices, in steps of so many millimetres.
std::string smallNrrd(const std::string& sizes, const std::string& step_mm) {
  std::string text = "NRRD0004\ntype: float\ndimension: 3\nsizes: " + sizes + "\nspacings: " + step_mm + " " + step_mm +
                     " " + step_mm + "\nencoding: ascii\n\n";
  for (int n = 0; n < 64; ++n) text += std::to_string(n) + " ";
  return text;
}

// A remedy that is in force already is none.
TEST_F(InfoVerb, ConvertNamesNoUnitThatIsInForce) {
  write("tiny.nrrd", smallNrrd("4 4 4", "1e-7"));
  for (const Words& unit : {Words{}, Words{"--unit", "mm"}, Words{"--unit", "m"}}) {
    const Outcome outcome = run(Words{"convert", "tiny.nrrd", "x.vdb"} + unit);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("too small for OpenVDB in this unit of length; "));
    EXPECT_EQ(outcome.err.find("use --unit mm") != std::string::npos, unit == (Words{"--unit", "m"})) << outcome.err;
  }
}

// What it has in common with touch is no reason to speak of that.
TEST_F(InfoVerb, ConvertOfOneSliceSpeaksOfItsSurface) {
  write("slice.nrrd", smallNrrd("8 8 1", "1"));
  expectRefusal(run({"convert", "slice.nrrd", "x.stl"}), "slice.nrrd", "and a surface needs two along every axis", 2);
}

}  // namespace info_verb_test
}  // namespace palpate
