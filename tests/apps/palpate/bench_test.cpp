// SPDX-License-Identifier: Apache-2.0
// palpate bench, as a user gives it: its files, its refusals, Ctrl-C. What it measures is tested in tests/apps/bench.
#include <csignal>

#include <nlohmann/json.hpp>

#include "program_test.hpp"

namespace palpate {
namespace bench_test {

using testing::HasSubstr;

class Bench : public ProgramTest {};

TEST_F(Bench, LoopWritesItsFilesAndEndsWithTheTargets) {
  const Outcome outcome = run({"bench", "loop", "--seconds", "0.1", "--seed", "5", "--json", "l.json", "--csv", "l.csv",
                               "--chart", "l.svg", "--page", "l.md"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-9]+ of [0-9]+ targets hold\n$"));
  const auto json = nlohmann::json::parse(contentsOf(file("l.json")));
  EXPECT_EQ(json["bench"], "loop");
  EXPECT_EQ(json["command"], "palpate bench loop --seconds 0.1 --seed 5");
  EXPECT_FALSE(json["commit"].get<std::string>().empty());
  EXPECT_FALSE(json["rows"].empty());
  EXPECT_THAT(contentsOf(file("l.csv")), testing::StartsWith("part,"));
  EXPECT_THAT(contentsOf(file("l.svg")), testing::StartsWith("<svg"));
  EXPECT_THAT(contentsOf(file("l.md")), HasSubstr("](l.svg)\n"));
}

TEST_F(Bench, LoopGoesOnWithoutCyclictest) {
  const Outcome outcome = runPalpate({.arguments = {"bench", "loop", "--seconds", "0.1", "--strict"},
                                      .folder = folder(),
                                      .environment = {{"PATH", "/nowhere"}}});
  EXPECT_EQ(outcome.status, 0) << outcome.err;  // no target, so none that does not hold
  EXPECT_THAT(outcome.out, HasSubstr("note: no comparison: cyclictest is not installed; apt-get install rt-tests"));
  EXPECT_THAT(outcome.out, HasSubstr("0 of 0 targets hold"));
}

// Whether VTK and SciPy are there or not.
TEST_F(Bench, FiltersWritesItsFilesAndEndsWithTheTargets) {
  const Outcome outcome =
      run({"bench", "filters", "--quick", "--json", "f.json", "--csv", "f.csv", "--chart", "f.svg", "--page", "f.md"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\ngaussian:1.5, 64.3: Palpate / ITK \\[-\\] +[0-9.]+  <= "));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-9] of [35] targets hold\n$"));  // five with VTK
  const auto json = nlohmann::json::parse(contentsOf(file("f.json")));
  EXPECT_EQ(json["bench"], "filters");
  EXPECT_EQ(json["command"], "palpate bench filters --quick --seed 1");
  EXPECT_THAT(contentsOf(file("f.csv")), HasSubstr("\nrun,median:1,64^3,262144,ITK,MedianImageFilter,"));
  EXPECT_THAT(contentsOf(file("f.svg")), testing::StartsWith("<svg"));
  EXPECT_THAT(contentsOf(file("f.md")), HasSubstr("](f.svg)\n"));
}

// The servo's program lies beside this one.
TEST_F(Bench, ServiceComparesTwoProcessesWithOne) {
  const Outcome outcome = run({"bench", "service", "--quick", "--seconds", "0.8", "--json", "s.json", "--csv", "s.csv",
                               "--chart", "s.svg", "--page", "s.md"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("[0-4] of 4 targets hold\n$"));
  const auto json = nlohmann::json::parse(contentsOf(file("s.json")));
  EXPECT_EQ(json["command"], "palpate bench service --quick --seconds 0.8 --seed 1");
  EXPECT_NE(json["vulkan_device"], "none");
  int runs = 0, ratios = 0;
  for (const auto& row : json["rows"]) {
    runs += row["part"] == "run" ? 1 : 0;
    ratios += row["part"] == "ratio" ? 1 : 0;
    for (const auto& [key, value] : row.items()) EXPECT_FALSE(value.is_null()) << key << " of " << row;
    if (row["part"] != "run") continue;
    EXPECT_GT(row["edits"], 0) << row;
    EXPECT_GT(row["windows"], 0) << row;
    EXPECT_GT(row["tick_cost_median_us"], 0) << row;
  }
  EXPECT_EQ(runs, 6);
  EXPECT_EQ(ratios, 10);
  for (const auto& target : json["targets"]) EXPECT_GT(target["value"], 0) << target;
  EXPECT_THAT(contentsOf(file("s.csv")), testing::StartsWith("part,"));
  EXPECT_THAT(contentsOf(file("s.svg")), testing::StartsWith("<svg"));
  EXPECT_THAT(contentsOf(file("s.md")), HasSubstr("](s.svg)\n"));
}

struct Refusal {
  const char* name;
  Words arguments;
  const char* input;
  const char* reason;
  int status = 2;
};

const Refusal kRefusals[] = {
    {"UnknownBench", {"bench", "colour"}, "colour", "no such verb"},
    {"NoBench", {"bench"}, "subcommand", "required"},
    {"Volume", {"bench", "servo", "phantom:box"}, "phantom:box", "not expected"},
    {"UnknownFlag", {"bench", "servo", "--fast"}, "--fast", "not expected"},
    {"SecondsOfServo", {"bench", "servo", "--seconds", "1"}, "--seconds", "not expected"},
    {"NoTime", {"bench", "loop", "--seconds", "0"}, "--seconds", "0"},
    {"NegativeTime", {"bench", "loop", "--seconds", "-3"}, "--seconds", "-3"},
    {"Word", {"bench", "loop", "--seconds", "long"}, "--seconds", "long"},
    {"NotANumber", {"bench", "loop", "--seconds", "nan"}, "--seconds", "nan"},
    {"NegativeSeed", {"bench", "servo", "--seed", "-1"}, "--seed", "-1"},
    {"SeedThatIsNoNumber", {"bench", "servo", "--seed", "one"}, "--seed", "one"},
    {"FileWithoutName", {"bench", "servo", "--json"}, "--json", "value is missing"},
    {"NoSuchFolder", {"bench", "servo", "--json", "nowhere/s.json"}, "nowhere/s.json", "cannot be created", 4},
    {"NoSuchFolderForTheChart", {"bench", "loop", "--chart", "nowhere/l.svg"}, "nowhere/l.svg", "cannot be created", 4},
    {"OneFileForTwo", {"bench", "servo", "--json", "a.out", "--csv", "./a.out"}, "./a.out", "two of the outputs"},
    {"UnknownGpu", {"bench", "loop", "--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
    {"UnknownGpuOfService", {"bench", "service", "--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
    {"SizeOfNoVolume", {"bench", "filters", "--sizes", "64,3"}, "--sizes", "3"},
    {"SizesOfServo", {"bench", "servo", "--sizes", "64"}, "--sizes", "not expected"},
    {"UnknownGpuOfFilters", {"bench", "filters", "--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
    {"UnknownStudy", {"bench", "error", "--study", "serwo"}, "--study serwo", "no such study"},
    {"NoShard", {"bench", "error", "--shard", "0/4"}, "--shard 0/4", "not the I-th of N parts"},
    {"ShardBeyondTheLast", {"bench", "error", "--shard", "5/4"}, "--shard 5/4", "not the I-th of N parts"},
    {"ShardThatIsNoNumber", {"bench", "error", "--shard", "a/b"}, "--shard a/b", "not the I-th of N parts"},
    {"ShardOfServo", {"bench", "servo", "--shard", "1/2"}, "--shard", "not expected"},
    {"ReportOfServo", {"bench", "servo", "--report", "a.html"}, "--report", "not expected"},
    {"UnknownGpuOfError", {"bench", "error", "--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
    {"MergeOfNothing", {"bench", "merge"}, "PART", "required"},
    {"AllOfAnUnknownBench", {"bench", "all", "--bench", "colour"}, "--bench colour", "no bench 'colour'"},
    {"AllInNoFolder", {"bench", "all", "--out", "/proc/nowhere"}, "/proc/nowhere", "cannot be created", 4},
    {"UnknownGpuOfGradient", {"bench", "gradient", "--gpu", "Voodoo"}, "--gpu Voodoo", "no usable device", 3},
};

class RefusedBench : public ProgramTest, public testing::WithParamInterface<Refusal> {};

TEST_P(RefusedBench, InOneLineAtOnce) {
  const Outcome outcome = run(GetParam().arguments);
  expectRefusal(outcome, GetParam().input, GetParam().reason, GetParam().status);
  EXPECT_EQ(outcome.out, "");
}

INSTANTIATE_TEST_SUITE_P(Each, RefusedBench, testing::ValuesIn(kRefusals),
                         [](const auto& refusal) { return std::string(refusal.param.name); });

TEST_F(Bench, StopsInGoodOrderAndLeavesNoFile) {
  struct Case {
    std::vector<std::string> arguments;
    std::string signal_at;
  };
  const std::vector<Case> cases = {{{"bench", "servo"}, "errors on phantom:knot"},
                                   {{"bench", "loop"}, "cyclictest at 1000"},
                                   {{"bench", "filters", "--sizes", "32"}, "gaussian:1.5, 32"}};
  for (const Case& one : cases) {
    std::vector<std::string> arguments = one.arguments;
    arguments.insert(arguments.end(), {"--json", "b.json"});
    const Outcome outcome =
        runPalpate({.arguments = arguments, .folder = folder(), .signal_at = one.signal_at, .signals = {SIGINT}});
    expectRefusal(outcome, "palpate bench", "stopped by the user", 130);
    EXPECT_TRUE(std::filesystem::is_empty(folder()));
  }
}

}  // namespace bench_test
}  // namespace palpate
