// SPDX-License-Identifier: Apache-2.0
// `palpate tune`, whose choice must keep what was asked for in a fresh `palpate touch`, or which says that it cannot.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace tune_verb_test {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

constexpr const char* kSmall = "phantom:sphere?size=24";

class TuneVerb : public ProgramTest {
 protected:
  [[nodiscard]] Outcome tune(const std::string& source, const Words& more) const {
    return run(Words{"tune", source, "--seconds", "0.5"} + more);
  }
  [[nodiscard]] Json json(const std::string& name) const { return Json::parse(contentsOf(file(name))); }

  // The summary of a fresh run of a scene.
  [[nodiscard]] Json touched(const std::string& scene) const {
    const Outcome outcome =
        run({"touch", scene, "--clock", "simulated", "--picture", "off", "--trace", "off", "--out", "fresh"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json("fresh/summary.json");
  }
};

TEST_F(TuneVerb, RefusesGoalsThatAreNone) {
  expectRefusal(tune(kSmall, {}), "palpate tune", "nothing is asked for", 2);
  expectRefusal(tune(kSmall, {"--error", "0.1N", "--budget", "2us"}), "--error and --budget", "both are given", 2);
  expectRefusal(tune(kSmall, {"--error", "0.1"}), "--error '0.1'", "it has no unit", 2);
  expectRefusal(tune(kSmall, {"--error", "2us"}), "--error '2us'", "'us' is no unit of it", 2);
  expectRefusal(tune(kSmall, {"--budget", "2N"}), "--budget '2N'", "'N' is no unit of it", 2);
  for (const char* none : {"0N", "-1N", "1e999N"})
    expectRefusal(tune(kSmall, {fmt::format("--error={}", none)}), "--error", "", 2);
  expectRefusal(tune(kSmall, {"--error", "nanN"}), "--error 'nanN'", "is", 2);
  EXPECT_FALSE(exists("tuned.toml"));
}

TEST_F(TuneVerb, RefusesWhatHasNoErrorToKeep) {
  expectRefusal(tune(kSmall, {"--error", "0.1N", "--algorithm", "haptization"}), "--algorithm haptization",
                "it shows no surface", 2);
  write("away.csv", "time_s,x_m,y_m,z_m\n0,0.011,0.011,0.011\n0.5,0.011,0.011,0.0105\n");
  expectRefusal(run({"tune", kSmall, "--path", "away.csv", "--error", "0.1N"}), kSmall, "feels no surface", 2);
  expectRefusal(run({"tune", "nothing.nrrd", "--error", "0.1N"}), "nothing.nrrd", "", 3);
  EXPECT_FALSE(exists("tuned.toml"));
}

// Edits take time at every tick, and trials have none: a budget would not be kept. An error is told as what it is.
TEST_F(TuneVerb, RefusesABudgetForAToolThatEdits) {
  const Words brush = {"--edit", "remove:radius=2mm"};
  expectRefusal(tune(kSmall, brush + Words{"--budget", "500us"}), kSmall, "its tool edits", 2);
  write("along.csv", "time_s,x_m,y_m,z_m,brush\n0,0.011,0.011,0.011,\n0.5,0.011,0.011,0.0105,remove:radius=2mm\n");
  expectRefusal(run({"tune", kSmall, "--path", "along.csv", "--budget", "500us"}), kSmall, "its tool edits", 2);
  EXPECT_FALSE(exists("tuned.toml"));
  const Outcome outcome = tune(kSmall, brush + Words{"--error", "1N"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Met       without its brush, in fresh runs"));
}

// Before any trial. A control character is no matter: the file holds it escaped, its comment without.
TEST_F(TuneVerb, RefusesNamesThatASceneCannotHold) {
  const std::string rows = "time_s,x_m,y_m,z_m\n0,0.011,0,0\n0.5,0.007,0,0\n";
  write("a\xFF.csv", rows);
  expectRefusal(run({"tune", kSmall, "--path", "a\xFF.csv", "--error", "1N"}), "a\xFF.csv", "not in UTF-8", 2);
  EXPECT_FALSE(exists("tuned.toml"));
  write("a\x7f\x01.csv", rows);
  EXPECT_EQ(run({"tune", kSmall, "--path", "a\x7f\x01.csv", "--error", "1N"}).status, 0);
  EXPECT_EQ(touched("tuned.toml")["scene"]["path"]["file"], "a\x7f\x01.csv");
}

TEST_F(TuneVerb, ReplacesItsOwnFilesOnly) {
  write("tuned.toml", "volume = 'mine'\n");
  expectRefusal(tune(kSmall, {"--error", "1N"}), "tuned.toml", "palpate tune did not write it", 2);
  EXPECT_EQ(contentsOf(file("tuned.toml")), "volume = 'mine'\n");
  EXPECT_EQ(tune(kSmall, {"--error", "1N", "--overwrite"}).status, 0);
  EXPECT_THAT(contentsOf(file("tuned.toml")), HasSubstr("# Written by palpate tune: palpate tune"));
  EXPECT_EQ(tune(kSmall, {"--error", "1N"}).status, 0);
  expectRefusal(tune(kSmall, {"--error", "1N", "-o", "a.toml", "--json", "./a.toml"}), "a.toml", "", 2);
  expectRefusal(tune(kSmall, {"--error", "1N", "-o", "a"}), "a", "a scene's name ends with .toml", 2);
  expectRefusal(tune(kSmall, {"--error", "1N", "-o", "none/a.toml"}), "none/a.toml", "", 4);
}

// What somebody added by hand is nobody's to lose: at the end, in between, or a character less.
TEST_F(TuneVerb, KeepsAFileOfItsOwnThatWasEdited) {
  ASSERT_EQ(tune(kSmall, {"--error", "1N"}).status, 0);
  const std::string written = contentsOf(file("tuned.toml"));
  std::string between = written;
  between.insert(between.find("volume"), "# mine\n");
  for (const std::string& edited : {written + "# mine\n", between, written.substr(0, written.size() - 1)}) {
    write("tuned.toml", edited);
    expectRefusal(tune(kSmall, {"--error", "1N"}), "tuned.toml", "was edited since palpate tune wrote it", 2);
    EXPECT_EQ(contentsOf(file("tuned.toml")), edited);
  }
  EXPECT_EQ(tune(kSmall, {"--error", "1N", "--overwrite"}).status, 0);
  EXPECT_EQ(contentsOf(file("tuned.toml")).find("mine"), std::string::npos);
}

TEST_F(TuneVerb, SaysThatAnEarlierSceneStays) {
  ASSERT_EQ(tune(kSmall, {"--error", "1N"}).status, 0);
  const std::string written = contentsOf(file("tuned.toml"));
  const Outcome outcome = tune(kSmall, {"--error", "1uN"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("tuned.toml is of an earlier run, and stays as it is"));
  EXPECT_EQ(contentsOf(file("tuned.toml")), written);
}

// What the user's scene says is in the new one, which lies beside it and is run from there.
TEST_F(TuneVerb, KeepsWhatTheSceneSays) {
  std::filesystem::create_directory(file("scenes"));
  expectSuccess(run({"convert", "phantom:sphere?size=24", "ball.nrrd"}));
  write("scenes/a.toml",
        "volume = '../ball.nrrd'\nisovalue = 12.5\n[servo]\nseconds = 0.5\nstiffness_N_per_m = 300\n[path]\n"
        "depth_mm = 0.7\n[[object]]\nkind = 'sphere'\ncentre_mm = [0, 0, 30]\nradius_mm = 5\n");
  const Outcome outcome = run({"tune", "scenes/a.toml", "--error", "0.05N", "--json", "a.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("since the volume is no phantom"));
  EXPECT_THAT(outcome.out, HasSubstr("filter none: as the scene has it"));
  const Json scene = touched("scenes/a.tuned.toml")["scene"];
  EXPECT_EQ(scene["isovalue"], 12.5);
  EXPECT_EQ(scene["servo"]["stiffness_N_per_m"], 300);
  EXPECT_EQ(scene["path"]["depth_mm"], 0.7);
  EXPECT_EQ(scene["objects"].size(), 1U);
  const Json found = json("a.json");
  EXPECT_EQ(found["schema"], "palpate.tune/1");
  EXPECT_TRUE(found["met"]);
  EXPECT_EQ(found["chosen"]["n_ticks"], scene["servo"]["n"]);
  EXPECT_EQ(found["chosen"]["window_voxel"], scene["window"]);
  EXPECT_EQ(found["chosen"]["samples"], scene["samples"]);
}

TEST_F(TuneVerb, SaysWhatItCannot) {
  const Outcome outcome = tune(kSmall, {"--error", "1uN", "--json", "a.json"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("Cannot    no candidate keeps --error 1e-06N; the nearest: operator"));
  EXPECT_THAT(outcome.out, HasSubstr("Needed    an error of "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("a stiffness of")));  // one of micronewtons a metre would be no wall
  EXPECT_FALSE(exists("tuned.toml"));
  EXPECT_FALSE(json("a.json")["met"]);
  EXPECT_THAT(tune(kSmall, {"--budget", "1ns"}).out, HasSubstr("Needed    a budget of "));
}

TEST_F(TuneVerb, FeelsAlgorithmsWithAndWithoutPlanes) {
  for (const char* algorithm : {"hri-paper", "god-object", "blezek"}) {
    if (std::string(algorithm) == "blezek" && !isLongRun()) continue;  // keeps no planes either
    SCOPED_TRACE(algorithm);
    const Outcome outcome = tune(kSmall, {"--error", "1N", "--algorithm", algorithm, "--hand", "spring"});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    const bool planes = std::string(algorithm).starts_with("hri");
    EXPECT_EQ(outcome.out.find("keeps no planes") == std::string::npos, planes);
    EXPECT_LE(touched("tuned.toml")["exact"]["force_error_p99_N"], 1.0);
  }
}

}  // namespace tune_verb_test
}  // namespace palpate
