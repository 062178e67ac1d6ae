// SPDX-License-Identifier: Apache-2.0
// palpate bench error, merge and all, as a user gives them. What they measure is tested in tests/apps/study.
#include <csignal>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace error_studies_test {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

const Words kServoQuick = {"bench", "error", "--quick", "--study", "servo"};

class ErrorStudies : public ProgramTest {
 protected:
  [[nodiscard]] Json jsonOf(const std::string& name) const { return Json::parse(contentsOf(file(name))); }

  // Runs a line in the shell, in the test's folder. Returns its exit status.
  [[nodiscard]] int shell(const std::string& line) const {
    const std::string command = fmt::format("cd '{}' && ( {} ) >shell.log 2>&1", folder().string(), line);
    return std::system(command.c_str());  // NOLINT(cert-env33-c, concurrency-mt-unsafe): a shell is what it tests
  }
};

// Without what differs from run to run: costs, what follows from them, and where cells were measured.
Json withoutCosts(const Json& result) {
  Json kept = Json::array();
  for (Json row : result["rows"]) {
    const std::string part = row["part"];
    if (part == "front" || part == "default" || part == "shard") continue;
    for (const char* key : {"shard", "cost_ns", "cost_ns_quartile_1", "cost_ns_quartile_3", "cost_ns_each"}) {
      row.erase(key);
    }
    kept.push_back(row);
  }
  Json targets = Json::array();
  for (const Json& target : result["targets"]) targets.push_back(target["name"]);
  return {{"command", result["command"]}, {"commit", result["commit"]}, {"rows", kept}, {"targets", targets}};
}

TEST_F(ErrorStudies, WriteTheirFilesAndEndWithTheTargets) {
  const Outcome outcome = run(kServoQuick + Words{"--seed", "5", "--json", "e.json", "--csv", "e.csv", "--chart",
                                                  "e.svg", "--page", "e.md", "--report", "e.html"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-9]+ of 5 targets hold\n$"));
  EXPECT_EQ(jsonOf("e.json")["command"], "palpate bench error --quick --study servo --seed 5");
  EXPECT_THAT(contentsOf(file("e.csv")), testing::StartsWith("part,"));
  EXPECT_THAT(contentsOf(file("e.svg")), HasSubstr("Pareto front"));
  EXPECT_THAT(contentsOf(file("e.md")), HasSubstr("](e.svg)\n"));
  EXPECT_THAT(contentsOf(file("e.md")), HasSubstr("Gradient operator `central`, samples as `float`, algorithm `hri` "
                                                  "with a plane every 5 ticks, windows of 32^3 samples, no filter."));
  EXPECT_THAT(contentsOf(file("e.html")), testing::EndsWith("</html>\n"));
}

// In the middle of the rounds, and before anything was measured.
TEST_F(ErrorStudies, CtrlCLeavesAValidPartialReport) {
  const Outcome outcome = runPalpate(
      {.arguments = {"bench", "error", "--study", "servo", "--json", "p.json", "--page", "p.md", "--report", "p.html"},
       .folder = folder(),
       .signal_at = "servo: round 1",
       .signals = {SIGINT}});
  expectRefusal(outcome, "palpate bench error", "stopped by the user", 130);
  const Json result = jsonOf("p.json");
  std::size_t measured = 0;
  for (const Json& row : result["rows"]) measured += row["part"] == "servo" ? 1 : 0;
  EXPECT_GT(measured, 0U);
  EXPECT_THAT(contentsOf(file("p.html")), testing::EndsWith("</html>\n"));
}

TEST_F(ErrorStudies, WhatAStoppedRunLacksIsSaid) {
  const Outcome outcome = runPalpate({.arguments = {"bench", "error", "--study", "servo", "--json", "p.json"},
                                      .folder = folder(),
                                      .signal_at = "servo: preparing",
                                      .signals = {SIGTERM}});
  expectRefusal(outcome, "palpate bench error", "stopped by the user", 130);
  EXPECT_THAT(outcome.out, testing::ContainsRegex("stopped by the user: [0-9]+ of [0-9]+ cells are missing"));
  EXPECT_EQ(jsonOf("p.json")["bench"], "error");
}

TEST_F(ErrorStudies, ShardsJoinToWhatOneRunHas) {
  ASSERT_EQ(run(kServoQuick + Words{"--json", "whole.json"}).status, 0);
  Words merge = {"bench", "merge"};
  const Words numbers = isLongRun() ? Words{"2", "1", "3"} : Words{"2", "1"};
  for (const std::string& number : numbers) {
    const std::string name = "part" + number + ".json";
    const std::string shard = fmt::format("{}/{}", number, numbers.size());
    ASSERT_EQ(run(kServoQuick + Words{"--shard", shard, "--json", name}).status, 0);
    merge.push_back(name);
  }
  const Outcome outcome = run(merge + Words{"--json", "joined.json", "--csv", "j.csv", "--report", "j.html"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-9]+ of 5 targets hold\n$"));
  EXPECT_EQ(withoutCosts(jsonOf("joined.json")), withoutCosts(jsonOf("whole.json")));
  EXPECT_TRUE(exists("j.csv") && exists("j.html"));
}

// As docs/error-studies.md has it.
TEST_F(ErrorStudies, ShardsRunUnderGnuParallel) {
  if (shell("command -v parallel") != 0) GTEST_SKIP() << "GNU parallel is not installed";
  ASSERT_EQ(
      shell(fmt::format("parallel -j2 '{0}' bench error --quick --study servo --shard {{}}/{1} --json part{{}}.json "
                        "::: {2} && '{0}' bench merge part?.json --json joined.json",
                        PALPATE_PROGRAM, isLongRun() ? 4 : 2, isLongRun() ? "1 2 3 4" : "1 2")),
      0)
      << contentsOf(file("shell.log"));
  EXPECT_FALSE(jsonOf("joined.json")["rows"].empty());
}

// The script of the documentation, with the variables that Slurm sets.
TEST_F(ErrorStudies, ShardsRunAsASlurmArray) {
  for (const char* task : {"1", "2"}) {
    ASSERT_EQ(shell(fmt::format("SLURM_ARRAY_TASK_ID={} SLURM_ARRAY_TASK_COUNT=2 PALPATE='{}' PALPATE_OUT=parts bash "
                                "'{}/error-studies.sbatch' --quick --study servo",
                                task, PALPATE_PROGRAM, PALPATE_DOCS)),
              0)
        << contentsOf(file("shell.log"));
  }
  const Outcome outcome = run({"bench", "merge", "parts/part1.json", "parts/part2.json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(ErrorStudies, DamagedPartsAreRefused) {
  write("empty.json", "");
  write("words.json", "these are no figures");
  write("other.json",
        R"({"bench":"edit","commit":"a","machine":"b","vulkan_device":"c","command":"d","rows":[],"targets":[]})");
  write("none.json",
        R"({"bench":"colours","commit":"a","machine":"b","vulkan_device":"c","command":"d","rows":[],"targets":[]})");
  write("error.json",
        R"({"bench":"error","commit":"a","machine":"b","vulkan_device":"c","command":"d","rows":[],"targets":[]})");
  expectRefusal(run({"bench", "merge", "empty.json"}), "empty.json", "damaged", 2);
  expectRefusal(run({"bench", "merge", "words.json"}), "words.json", "damaged", 2);
  expectRefusal(run({"bench", "merge", "other.json"}), "other.json", "bench edit is not made of shards", 2);
  expectRefusal(run({"bench", "merge", "none.json"}), "none.json", "there is no bench 'colours'", 2);
  expectRefusal(run({"bench", "merge", "error.json"}), "error.json", "no shard of a bench", 2);
  expectRefusal(run({"bench", "merge", "nowhere.json"}), "nowhere.json", "no such file", 3);
  expectRefusal(run({"bench", "merge", "."}), ".", "no plain file", 2);
}

TEST_F(ErrorStudies, AResultIsShownAgain) {
  ASSERT_EQ(run(kServoQuick + Words{"--json", "e.json", "--chart", "all.svg", "--csv", "e.csv"}).status, 0);
  const Outcome outcome = run({"bench", "show", "e.json", "--csv", "again.csv", "--chart", "again.svg"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-9]+ of 5 targets hold\n$"));
  EXPECT_EQ(contentsOf(file("again.csv")), contentsOf(file("e.csv")));
  EXPECT_EQ(contentsOf(file("again.svg")), contentsOf(file("all.svg")));
}

TEST_F(ErrorStudies, OnePanelOfTheChartIsDrawn) {
  ASSERT_EQ(run(kServoQuick + Words{"--json", "e.json"}).status, 0);
  ASSERT_EQ(run({"bench", "show", "e.json", "--chart", "one.svg", "--panel", "angle"}).status, 0);
  const std::string chart = contentsOf(file("one.svg"));
  EXPECT_THAT(chart, HasSubstr(">angle<"));
  EXPECT_THAT(chart, testing::Not(HasSubstr(">position<")));
  const Outcome no_chart = run({"bench", "show", "e.json", "--panel", "angle"});
  EXPECT_EQ(no_chart.status, 2);
  EXPECT_THAT(no_chart.err, testing::HasSubstr("--panel requires --chart"));
  expectRefusal(run({"bench", "show", "e.json", "--json", "kept.json", "--chart", "none.svg", "--panel", "angel"}),
                "angel", "no panel of the chart has this title; did you mean angle?", 2);
  EXPECT_TRUE(exists("kept.json"));
  EXPECT_FALSE(exists("none.svg"));
}

TEST_F(ErrorStudies, WhatCannotBeShownIsRefused) {
  const char* head =
      R"(,"commit":"a","machine":"b","vulkan_device":"c","command":"d","rows":[{"part":"edit"}],"targets":[]})";
  write("edit.json", std::string(R"({"bench":"edit")") + head);
  write("none.json", std::string(R"({"bench":"colours")") + head);
  expectRefusal(run({"bench", "show", "edit.json"}), "edit.json", "its rows are not those of bench edit", 2);
  expectRefusal(run({"bench", "show", "edit.json", "--report", "r.html"}), "--report", "bench edit has no report", 2);
  expectRefusal(run({"bench", "show", "none.json"}), "none.json", "there is no bench 'colours'", 2);
  expectRefusal(run({"bench", "show", "nowhere.json"}), "nowhere.json", "no such file", 3);
}

// The loop bench is given no device, so it fails; the servo bench opens none.
TEST_F(ErrorStudies, AllBenchesGoOnWhenOneFails) {
  const Outcome outcome = run({"bench", "all", "--quick", "--bench", "loop,error", "--gpu", "Voodoo", "--out", "b"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("loop: failed: it ended with status 3"));
  EXPECT_THAT(outcome.out, HasSubstr("error: failed: it ended with status 3"));
  const std::string page = contentsOf(file("b/all.md"));
  EXPECT_THAT(page, HasSubstr("| loop | How well the loop keeps its times | **failed**"));
  EXPECT_THAT(page, HasSubstr("- command: `palpate bench all --quick --bench loop,error --gpu Voodoo`"));
}

TEST_F(ErrorStudies, AllBenchesAreGatheredOnOnePage) {
  const Outcome outcome = run({"bench", "all", "--quick", "--bench", "filters", "--out", "b"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("filters: [0-9]+ of [0-9]+ targets hold, [0-9]+ s\n"));
  EXPECT_THAT(contentsOf(file("b/all.md")), HasSubstr("| [filters](filters.md) | What filters cost | "));
  for (const char* name : {"b/filters.json", "b/filters.csv", "b/filters.svg", "b/filters.md"})
    EXPECT_TRUE(exists(name)) << name;
}

TEST_F(ErrorStudies, AllBenchesStopWithTheOneThatRuns) {
  const Outcome outcome = runPalpate({.arguments = {"bench", "all", "--quick", "--bench", "servo,load", "--out", "b"},
                                      .folder = folder(),
                                      .signal_at = "errors on phantom:knot",
                                      .signals = {SIGTERM}});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("palpate bench all: stopped by the user; the page holds the benches before that"));
  EXPECT_THAT(contentsOf(file("b/all.md")), testing::Not(HasSubstr("| load")));
}

}  // namespace error_studies_test
}  // namespace palpate
