// SPDX-License-Identifier: Apache-2.0
// Flags that cannot be used: one line that names the flag, the reason and the remedy; exit status 2; nothing written.
#include "program_test.hpp"

namespace palpate {
namespace refused_flag_test {

struct BadFlags {
  const char* name;
  Words flags;
  const char* input;
  const char* reason;
  int status = 2;
};

const BadFlags kBadFlags[] = {
    {"PlaneEveryZeroTicks", {"--n", "0"}, "--n", "'0'"},
    {"HalfATick", {"--n", "1.5"}, "--n", "'1.5'"},
    {"Word", {"--n", "five"}, "--n", "'five'"},
    {"NothingGiven", {"--n", ""}, "--n", "''"},
    {"TrailingGarbage", {"--stiffness", "500N"}, "--stiffness", "'500N'"},
    {"NegativeStiffness", {"--stiffness", "-1"}, "--stiffness", "'-1'"},
    {"InfiniteStiffness", {"--stiffness", "inf"}, "--stiffness", "'inf'"},
    {"NegativeDamping", {"--damping", "-0.5"}, "--damping", "'-0.5'"},
    {"NoRate", {"--rate", "0"}, "--rate", "'0'"},
    {"NanRate", {"--rate", "nan"}, "--rate", "'nan'"},
    {"RateAboveWhatAServoCan", {"--rate", "1e9"}, "--rate", "'1e9'"},
    {"NoTime", {"--seconds", "0"}, "--seconds", "'0'"},
    {"NegativeTime", {"--seconds", "-3"}, "--seconds", "'-3'"},
    {"LessThanATick", {"--seconds", "0.01", "--rate", "10"}, "--seconds 0.01 at --rate 10", "no tick"},
    {"NanIsovalue", {"--iso", "nan"}, "--iso", "'nan'"},
    {"UnknownHand", {"--hand", "soft"}, "--hand", "'soft'"},
    {"UnknownClock", {"--clock", "fast"}, "--clock", "'fast'"},
    {"UnknownGradient", {"--gradient", "some"}, "--gradient", "'some'"},
    {"UnknownSwitch", {"--trace", "no"}, "--trace", "'no'"},
    {"UnknownAlgorithm", {"--algorithm", "magic"}, "algorithm", "'magic'"},
    {"UnknownVelocity", {"--velocity", "kalman"}, "velocity", "'kalman'"},
    {"NegativeCutoff", {"--velocity-cutoff", "-1"}, "--velocity-cutoff", "'-1'"},
    {"NegativeNoise", {"--velocity-noise", "-1"}, "--velocity-noise", "'-1'"},
    {"UnknownPassivity", {"--passivity", "off"}, "--passivity", "'off'"},
    {"NoStallTime", {"--stall", "0"}, "--stall", "'0'"},
    {"NanReportTimeout", {"--report-timeout", "nan"}, "--report-timeout", "'nan'"},
    {"ShortRow", {"--haptization-density", "1:2"}, "--haptization-density", "'1:2'"},
    {"UnsortedRows",
     {"--algorithm", "haptization", "--haptization-density", "5:0:0,-5:1:0"},
     "--haptization-density (key haptization.density)",
     "row 2"},
    {"NegativeViscosity",
     {"--algorithm", "haptization", "--haptization-density", "-1000:0:0,0:1:-1"},
     "--haptization-density (key haptization.density)",
     "row 2"},
    {"UnknownGpu", {"--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
    {"NoDirection", {"--toward", "0,0,0"}, "--toward", "'0,0,0'"},
    {"TwoNumbers", {"--toward", "1,0"}, "--toward", "'1,0'"},
    {"SmallPicture", {"--width", "10"}, "--width", "'10'"},
    {"NegativeDepth", {"--depth", "-1"}, "--depth", "'-1'"},
    {"NoBrush", {"--edit", ""}, "--edit", "'' is empty; give text, or leave it out"},
    {"NoJournal", {"--journal", ""}, "--journal", "'' is empty"},
    {"NoSave", {"--save", ""}, "--save", "'' is empty"},
    {"NoPath", {"--path", ""}, "--path", "'' is empty"},
    {"LargeBrush",
     {"--edit", "remove:radius=500", "--picture", "off", "--clock", "simulated"},
     "--edit remove:radius=500: ",
     "its radius of 500 mm is larger than the volume"},
    {"UnknownFlag", {"--stifness", "500"}, "--stifness", "not expected"},
    {"FlagWithoutValue", {"--n"}, "--n: ", "its value is missing; give one; "},
    {"FlagGivenTwice", {"--n", "1", "--n", "2"}, "--n: ", "it is given more than once; give it once; "},
    {"OtherUnit", {"--depth", "5um"}, "--depth", "'5um' is not what it takes; give a number from 0 to 100, in mm"},
    {"PlaceWithUnit", {"--start", "1cm,0,0"}, "--start", "give x,y,z, in mm"},
    {"SecondVolume", {"phantom:box"}, "phantom:box", "not expected"},
};

class RefusedFlag : public ProgramTest, public testing::WithParamInterface<BadFlags> {};

TEST_P(RefusedFlag, InOneLineAndWithoutAnOutputFolder) {
  // Not quickTouch(): a flag that it gives must not be given twice.
  const Outcome outcome = run(Words{"touch", "phantom:sphere?size=16"} + GetParam().flags);
  expectRefusal(outcome, GetParam().input, GetParam().reason, GetParam().status);
  EXPECT_FALSE(exists("out"));
}

INSTANTIATE_TEST_SUITE_P(Each, RefusedFlag, testing::ValuesIn(kBadFlags),
                         [](const auto& flags) { return std::string(flags.param.name); });

class RefusedWords : public ProgramTest {};

TEST_F(RefusedWords, UnknownVerb) {
  expectRefusal(run({"tuoch", "phantom:sphere"}), "tuoch", "no such verb", 2);
  expectRefusal(run({"check", "colour"}), "colour", "no such verb", 2);
}

TEST_F(RefusedWords, MissingVerb) {
  expectRefusal(run({}), "subcommand", "required", 2);
  expectRefusal(run({"check"}), "subcommand", "required", 2);
}

TEST_F(RefusedWords, MissingVolume) {
  expectRefusal(run({"touch"}), "VOLUME", "no volume", 2);
  expectRefusal(run({"plan"}), "VOLUME", "no volume", 2);
  expectRefusal(run({"info"}), "volume", "required", 2);
  expectRefusal(run({"check", "gradient"}), "volume", "required", 2);
}

TEST_F(RefusedWords, UnknownFlagOfEachVerb) {
  for (const Words& verb : {Words{"info", "phantom:box"}, Words{"check", "gradient", "phantom:box"}, Words{"devices"},
                            Words{"plan", "phantom:box"}, Words{"scene"}}) {
    expectRefusal(run(verb + Words{"--wrong"}), "--wrong", "not expected", 2);
  }
}

TEST_F(RefusedWords, BoundThatIsNoCount) {
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--bound", "-1"}), "--bound", "-1", 2);
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--bound", "some"}), "--bound", "some", 2);
}

}  // namespace refused_flag_test
}  // namespace palpate
