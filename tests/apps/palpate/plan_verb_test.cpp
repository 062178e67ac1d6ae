// SPDX-License-Identifier: Apache-2.0
// `palpate plan`: what a scene does and leaves out, what it costs, and what is refused.
#include <nlohmann/json.hpp>

#include "program_test.hpp"

namespace palpate {
namespace plan_verb_test {

using testing::HasSubstr;

class PlanVerb : public ProgramTest {};

TEST_F(PlanVerb, PlanSaysWhatIsDoneAndWhatIsLeftOut) {
  const Outcome all = run({"plan", "phantom:sphere?size=64", "--rounds", "0"});
  expectSuccess(all);
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  do +.*gradient of up to [0-9]+ of 512 bricks"));
  EXPECT_THAT(all.out, testing::StartsWith("phantom:sphere?size=64 at isovalue 0 on "));
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  do  +[0-9]+ of 512 bricks of density +-[0-9.]+ MiB  a brick that"));
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  leave  +contact effects  +the scene names none\n"));
  const Outcome less = run({"plan", "phantom:sphere?size=64", "--picture", "off", "--rounds", "0"});
  expectSuccess(less);
  EXPECT_THAT(less.out, testing::ContainsRegex("\n  leave +"));
  EXPECT_FALSE(exists("out"));  // a plan writes nothing
}

// With everything on that goes together, each pipeline, buffer and library has words that say what it is for.
TEST_F(PlanVerb, PlanSaysOfEverythingWhatItIsFor) {
  const Outcome outcome = run({"plan", "phantom:sphere?size=32", "--rounds", "0", "--json", "plan.json", "--filter",
                               "median:1", "--gradient-operator", "gaussian:1", "--edit", "smooth:radius=2mm",
                               "--friction-static", "0.5", "--object", "sphere:centre=0,0,100000:radius=5"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("kept, since edits change it"));  // the smoothed field
  const auto plan = nlohmann::json::parse(contentsOf(file("plan.json")));
  for (const char* list : {"pipelines", "buffers"}) {
    EXPECT_GE(plan["counted"][list].size(), 6U);
    for (const auto& item : plan["counted"][list]) EXPECT_NE(item["why"], "") << item;
  }
  for (const auto& module : plan["modules"]) EXPECT_NE(module["why"], "") << module;
  EXPECT_EQ(plan["effects"], "friction");
  EXPECT_GT(plan["counted"]["effect_runs"], 0);
  for (const char* name : {"palpate", "engine", "servo"})
    EXPECT_THAT(plan["counted"]["threads"], testing::Contains(name));
  EXPECT_TRUE(plan["features"].empty());
}

// The plan names the operator and says what halves save, and that a smoothed field is freed where nothing edits.
TEST_F(PlanVerb, PlanSaysOperatorAndSamples) {
  const Outcome half =
      run({"plan", "phantom:sphere?size=24", "--gradient-operator", "central4", "--samples", "half", "--rounds", "0"});
  expectSuccess(half);
  EXPECT_THAT(half.out, HasSubstr(": central4"));
  EXPECT_THAT(half.out, HasSubstr("samples as halves"));
  const Outcome smooth = run({"plan", "phantom:sphere?size=24", "--gradient-operator", "gaussian:1", "--rounds", "0"});
  expectSuccess(smooth);
  EXPECT_THAT(smooth.out, HasSubstr("smoothing of the whole field"));
  EXPECT_THAT(smooth.out, HasSubstr("freed then"));
  expectRefusal(run({"touch", "phantom:sphere?size=24", "--gradient-operator", "prewitt"}), "prewitt", "central4", 2);
  EXPECT_FALSE(exists("out"));
}

// One round: every feature is switched once, and none of the files that the scene names is written.
TEST_F(PlanVerb, PlanMeasuresEveryFeature) {
  const Outcome outcome =
      run({"plan", "phantom:sphere?size=16", "--rounds", "1", "--picture", "off", "--edit", "remove:radius=2mm",
           "--journal", "journal", "--save", "saved.vdb", "--json", "plan.json"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("\n| has | a journal | "));
  EXPECT_THAT(outcome.out, HasSubstr("\n| lacks | filters (gaussian:1) | "));
  const auto plan = nlohmann::json::parse(contentsOf(file("plan.json")));
  for (const auto& feature : plan["features"]) {
    const std::string why = feature.value("not_measured", "");
    if (feature["name"] == "a mesh of the isosurface") {  // which edits would leave behind
      EXPECT_THAT(why, HasSubstr("god-object feels a mesh that is made once"));
    } else {
      EXPECT_EQ(why, "") << feature["name"];
    }
  }
  for (const char* name : {"journal", "saved.vdb", "out"}) EXPECT_FALSE(exists(name)) << name;
}

// On a box as large as its volume no path begins outside; its passes are told all the same.
TEST_F(PlanVerb, PlanOfWhatCannotBeTouchedSaysWhy) {
  const Outcome outcome = run({"plan", "phantom:sphere?size=16", "--rounds", "0", "--start", "900,0,0"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("bricks of density"));
  EXPECT_THAT(outcome.out, HasSubstr("\nNothing was counted: the run that should be counted failed: "));
}

TEST_F(PlanVerb, PlanRefusesWhatTouchRefuses) {
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--rounds", "-1"}), "--rounds", "-1", 2);
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--json", "no/such/folder/p.json"}), "no/such/folder", "", 4);
  expectSuccess(run({"convert", "phantom:sphere?size=16", "in.vdb"}));
  expectRefusal(run({"plan", "in.vdb", "--json", "in.vdb"}), "in.vdb", "it is the input", 2);
  write("scene.toml", "volume = \"in.vdb\"\n");
  write("way.csv", "time_s,x_m,y_m,z_m\n0,9,0,0.01\n0.1,9,0,0\n");
  expectRefusal(run({"plan", "scene.toml", "--json", "scene.toml"}), "scene.toml", "the scene is made of it", 2);
  expectRefusal(run({"plan", "in.vdb", "--path", "way.csv", "--json", "way.csv"}), "way.csv", "the scene is made of it",
                2);
  for (const char* output : {"--json", "-o"}) {
    expectRefusal(run({"tune", "scene.toml", "--error", "1N", "--overwrite", output, "scene.toml"}), "scene.toml",
                  "the scene is made of it", 2);
    expectRefusal(run({"tune", "in.vdb", "--error", "1N", "--overwrite", output, "in.vdb"}), "in.vdb",
                  "it is the input", 2);
  }
  expectRefusal(run({"plan", "nowhere.nrrd"}), "nowhere.nrrd", "no such file", 3);
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--iso", "9999"}), "phantom:sphere", "isovalue", 2);
}

}  // namespace plan_verb_test
}  // namespace palpate
