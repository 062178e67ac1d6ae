// SPDX-License-Identifier: Apache-2.0
// Verbs that compute fields, `palpate filter` and `gradient`, and the checks of them against their twins.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/filter/filter_spec.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace field_verbs_test {

using testing::HasSubstr;

class FieldVerbs : public ProgramTest {};

TEST_F(FieldVerbs, GradientWritesVectorsAndRefusesItsInput) {
  const Outcome outcome = run({"gradient", "phantom:sphere?size=24", "-o", "g.vdb", "--operator", "sobel"});
  expectSuccess(outcome);
  EXPECT_TRUE(exists("g.vdb"));
  EXPECT_THAT(outcome.out, HasSubstr("sobel gradient of"));
  expectSuccess(run({"convert", "phantom:sphere?size=24", "v.vdb"}));
  expectRefusal(run({"gradient", "v.vdb", "-o", "v.vdb"}), "v.vdb", "it is the input", 2);
}

TEST_F(FieldVerbs, FilterTakesTheIsovalueOfADistance) {
  const Words words = {"filter", "phantom:sphere?size=24", "-o", "d.nrrd", "--filter", "distance:3"};
  const Outcome own = run(words);
  expectSuccess(own);
  EXPECT_THAT(own.out, HasSubstr("densities -0.003 to 0.003"));
  expectSuccess(run(words + Words{"--iso", "50"}));
  for (const char* beyond : {"1e9", "1e300", "nan"}) {
    const Outcome refused = run(words + Words{"--iso", beyond});
    EXPECT_EQ(refused.status, 2) << beyond;
    expectRefusal(run({"check", "filters", "phantom:sphere?size=24", "--filter", "distance:3", "--iso", beyond}),
                  "phantom:sphere", "isovalue", 2);
  }
}

// An isovalue that nothing reads would be without effect, and nobody would know.
TEST_F(FieldVerbs, FilterAndItsCheckRefuseAnIsovalueWithoutADistance) {
  const Words more = {"phantom:sphere?size=24", "--filter", "gaussian:1", "--iso", "50"};
  expectRefusal(run(Words{"filter", "-o", "d.nrrd"} + more), "--iso", "has a use for an isovalue", 2);
  expectRefusal(run(Words{"check", "filters"} + more), "--iso", "leave it out, or add a distance", 2);
  EXPECT_FALSE(exists("d.nrrd"));
}

// A distance has its surface at 0, wherever the density had it; Otsu would say otherwise.
TEST_F(FieldVerbs, FilterKeepsOrTellsTheIsovalueOfItsResult) {
  const Words filter = {"filter", "phantom:sphere?size=24", "--filter", "gaussian:0.7 distance:3", "--iso", "50", "-o"};
  EXPECT_THAT(run(filter + Words{"d.vdb"}).out, HasSubstr("its surface is at 0, which the file keeps"));
  EXPECT_THAT(run({"info", "d.vdb"}).out, HasSubstr("surface      at isovalue 0, which the file keeps"));
  EXPECT_THAT(run(filter + Words{"d.nrrd"}).out, HasSubstr("give --iso 0 where it is used"));
  expectSuccess(run({"filter", "phantom:knot?size=24&noise=0.05", "--filter", "gaussian:1", "-o", "p.vdb"}));
  EXPECT_THAT(run({"info", "p.vdb"}).out, HasSubstr("surface      at isovalue 0, which the file keeps"));
}

TEST_F(FieldVerbs, FilterSaysHowFarItReaches) {
  const Words filter = {"filter", "phantom:sphere?size=24&spacing=1x1x3mm", "-o", "f.vdb", "--filter"};
  EXPECT_THAT(run(filter + Words{"median:2mm"}).out, HasSubstr("1 pass reaching 2 x 2 x 0 voxels"));
  EXPECT_THAT(run(filter + Words{"median:0.2mm"}).out, HasSubstr("no size reaches a neighbouring voxel"));
  EXPECT_THAT(run(filter + Words{"gaussian:100"}).err,
              HasSubstr("gaussian of 100 voxels: along axis i it reaches 300"));
}

TEST_F(FieldVerbs, CheckCountsAndReports) {
  const Outcome outcome = run({"check", "gradient", "phantom:random?size=13x21x10", "--json", "check.json"});
  expectSuccess(outcome);
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  EXPECT_EQ(json["compared"], 4 * 13 * 21 * 10);
  EXPECT_EQ(json["differing"], 0);
  EXPECT_EQ(json["holds"], true);
  EXPECT_THAT(contentsOf(file("check.json")), testing::StartsWith("{\n  \"check\": \"gradient\",\n"));
  const Outcome bounded = run({"check", "gradient", "phantom:random?size=13x21x10", "--bound", "3"});
  expectSuccess(bounded);
  for (const auto& [text, bound] : {std::pair(outcome.out, "0"), std::pair(bounded.out, "3")}) {
    EXPECT_THAT(text, testing::StartsWith("gradient of phantom:random?size=13x21x10 on "));
    EXPECT_THAT(text, HasSubstr(fmt::format(": central, stored as float\n"
                                            "  values compared            10920\n"
                                            "  differing values               0\n"
                                            "  largest                        0 ULP\n"
                                            "  bound                          {} ULP: holds\n",
                                            bound)));
  }
}

// Every operator, and both forms of samples, differ in no bit from the twin. But in a long run an operator has one
// form, in turn.
TEST_F(FieldVerbs, CheckTakesOperatorsAndSamples) {
  bool takes_half = false;
  for (const char* way : {"central", "sobel", "central4", "gaussian:1.2"}) {
    takes_half = !takes_half;
    for (const char* samples : {"float", "half"}) {
      if (!isLongRun() && (std::string(samples) == "half") != takes_half) continue;
      const Outcome outcome = run({"check", "gradient", "phantom:random?size=13x21x10", "--operator", way, "--samples",
                                   samples, "--json", "check.json"});
      expectSuccess(outcome);
      const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
      EXPECT_EQ(json["compared"], 4 * 13 * 21 * 10);
      EXPECT_EQ(json["differing"], 0) << way << " " << samples;
      EXPECT_EQ(json["operator"], way);
      EXPECT_EQ(json["samples"], samples);
    }
  }
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--operator", "prewitt"}), "prewitt", "central4", 2);
}

TEST_F(FieldVerbs, CheckOfFiltersTellsEachAndHolds) {
  const Outcome outcome = run({"check", "filters", "phantom:random?size=13x21x10", "--json", "check.json"});
  expectSuccess(outcome);
  for (const FilterWords& words : filterTable()) EXPECT_THAT(outcome.out, HasSubstr(std::string(words.name) + ":"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\n([0-9]+) of [0-9]+ checks hold\n"));
  EXPECT_THAT(outcome.out, HasSubstr("bilateral: exponentials"));  // why that one has a bound
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  EXPECT_EQ(json["check"], "filters");
  EXPECT_EQ(json["holds"], true);
  EXPECT_GT(json["checks"].size(), 2 * filterTable().size());
}

TEST_F(FieldVerbs, CheckOfFiltersTakesAChainACropAndAnIsovalue) {
  const Outcome outcome = run({"check", "filters", "phantom:knot?size=30", "--filter", "gaussian:1 distance:2", "--iso",
                               "10", "--crop", "12", "--json", "check.json"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("its middle 12 x 12 x 12 voxels"));
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  // Three axes, the distance, the distance against brute force, and the chain.
  ASSERT_EQ(json["checks"].size(), 6U);
  EXPECT_EQ(json["checks"][5]["compared"], 12 * 12 * 12);
  expectRefusal(run({"check", "filters", "phantom:box?size=8", "--filter", "mean:1"}), "mean", "there is no filter", 2);
}

TEST_F(FieldVerbs, CheckFiltersLeavesDistancesOutOfAVolumeOfOneDensity) {
  ASSERT_EQ(run({"filter", "phantom:sphere?size=16", "--filter", "erode:16", "-o", "flat.nrrd"}).status, 0);
  const Outcome outcome = run({"check", "filters", "flat.nrrd"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("distances are left out"));
}

TEST_F(FieldVerbs, CheckOfEditsAndOfAllOnAVolume) {
  const Outcome edits = run({"check", "edits", "phantom:knot?size=24", "--edits", "30", "--seed", "5"});
  expectSuccess(edits);
  EXPECT_THAT(edits.out, HasSubstr("30 at random, seed 5"));
  EXPECT_THAT(edits.out, HasSubstr("1 of 1 checks hold"));
  const Outcome all = run({"check", "all", "phantom:knot?size=14", "--quick", "--page", "page.md"});
  expectSuccess(all);
  EXPECT_THAT(contentsOf(file("page.md")), HasSubstr("`palpate check all phantom:knot?size=14 --quick --seed 1`"));
  EXPECT_THAT(contentsOf(file("page.md")), HasSubstr("- `phantom:knot?size=14`"));
  for (const char* kind : {"gradient", "filter", "edits"})
    EXPECT_THAT(all.out, testing::ContainsRegex(std::string("\n  yes +") + kind));
  expectRefusal(run({"check", "edits", "phantom:box?size=8", "--iso", "1e9"}), "phantom:box", "isovalue", 2);
}

// Of a range both ends are taken and what is beyond is not; the page names what was given.
TEST_F(FieldVerbs, CheckTakesTheEndsOfItsRanges) {
  const Words median = {"check", "filters", "phantom:random?size=9x4x3", "--filter", "median:1", "--crop"};
  const Outcome cut = run(median + Words{"2"});
  expectSuccess(cut);
  EXPECT_THAT(cut.out, HasSubstr("(its middle 2 x 2 x 2 voxels)"));
  expectRefusal(run(median + Words{"1"}), "--crop", "1", 2);
  const Words edits = {"check", "edits", "phantom:random?size=9x4x3", "--edits"};
  EXPECT_THAT(run(edits + Words{"1"}).out, HasSubstr("1 at random, seed 1"));
  expectRefusal(run(edits + Words{"0"}), "--edits", "0", 2);
  expectSuccess(run({"convert", "phantom:random?size=6", "scan.nrrd"}));
  const Outcome all =
      run({"check", "all", file("scan.nrrd").string(), "--quick", "--crop", "5", "--seed", "7", "--page", "page.md"});
  expectSuccess(all);
  EXPECT_THAT(contentsOf(file("page.md")),
              HasSubstr("- command: `palpate check all scan.nrrd --quick --crop 5 --seed 7`\n"));
}

TEST_F(FieldVerbs, CheckRefusesAFileThatCannotBeWrittenBeforeTheWork) {
  const Outcome outcome = run({"check", "gradient", "phantom:random?size=8", "--json", "none/a.json"});
  expectRefusal(outcome, "none/a.json", "cannot be created", 4);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("loading")));
}

TEST_F(FieldVerbs, CheckRefusesAResultFileThatCannotBeWritten) {
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--json", "nowhere/check.json"}), "nowhere/check.json",
                "cannot be created", 4);
}

}  // namespace field_verbs_test
}  // namespace palpate
