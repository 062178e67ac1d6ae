// SPDX-License-Identifier: Apache-2.0
// The form is a contract (the same for every bench), so its keys and their order are spelled out here.
#include "apps/bench/bench_result.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace bench_result_test {

using testing::ElementsAre;
using testing::HasSubstr;

BenchResult sample() {
  BenchResult result;
  result.bench = "servo";
  result.commit = "0123456789";
  result.machine = "a machine, 2 cores";
  result.command = "palpate bench servo --seed 1";
  result.rows.push_back({{"part", "tick"}, {"n_ticks", std::int64_t{5}}, {"cost_ns", 31.5}});
  result.rows.push_back({{"part", "strokes"}, {"speed_m_per_s", 0.05}, {"wall", "shell, \"thin\""}});
  result.note("something is missing");
  result.targets = {{"cost [ns]", 31.5, 35}, {"error [voxel]", 0.02, 0.015}};
  return result;
}

std::vector<std::string> keysOf(const nlohmann::ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

TEST(BenchResult, JsonHasTheOneForm) {
  const auto json = nlohmann::ordered_json::parse(jsonText(sample()));
  EXPECT_THAT(keysOf(json), ElementsAre("bench", "commit", "machine", "vulkan_device", "command", "rows", "targets"));
  EXPECT_EQ(json["bench"], "servo");
  EXPECT_EQ(json["vulkan_device"], "none");
  ASSERT_EQ(json["rows"].size(), 3U);
  EXPECT_THAT(keysOf(json["rows"][0]), ElementsAre("part", "n_ticks", "cost_ns"));
  EXPECT_TRUE(json["rows"][0]["n_ticks"].is_number_integer());
  EXPECT_EQ(json["rows"][0]["cost_ns"], 31.5);
  ASSERT_EQ(json["targets"].size(), 2U);
  EXPECT_THAT(keysOf(json["targets"][0]), ElementsAre("name", "value", "bound", "holds"));
  EXPECT_EQ(json["targets"][0]["holds"], true);
  EXPECT_EQ(json["targets"][1]["holds"], false);
}

TEST(BenchResult, WithoutRowsAndTargetsTheyAreEmptyLists) {
  const auto json = nlohmann::json::parse(jsonText(BenchResult{}));
  EXPECT_EQ(json["rows"], nlohmann::json::array());
  EXPECT_EQ(json["targets"], nlohmann::json::array());
}

TEST(BenchResult, AFigureThatIsNoNumberIsNullAndHoldsNothing) {
  BenchResult result;
  result.rows.push_back({{"cost_ns", std::nan("")}});
  result.targets.push_back({"cost [ns]", std::nan(""), 35});
  const auto json = nlohmann::json::parse(jsonText(result));
  EXPECT_TRUE(json["rows"][0]["cost_ns"].is_null());
  EXPECT_EQ(json["targets"][0]["holds"], false);
  EXPECT_FALSE(result.allHold());
}

TEST(BenchResult, ATargetHoldsAtItsBound) {
  EXPECT_TRUE((BenchTarget{"falls [-]", 0, 0}.holds()));
  EXPECT_FALSE((BenchTarget{"falls [-]", 1, 0}.holds()));
  EXPECT_TRUE(BenchResult{}.allHold());
  EXPECT_FALSE(sample().allHold());
}

TEST(BenchResult, CsvHasTheUnionOfKeysAndQuotesWhatNeedsIt) {
  EXPECT_EQ(csvText(sample()),
            "part,n_ticks,cost_ns,speed_m_per_s,wall,note\n"
            "tick,5,31.5,,,\n"
            "strokes,,,0.05,\"shell, \"\"thin\"\"\",\n"
            "note,,,,,something is missing\n");
}

TEST(BenchResult, ANoteMovesNoColumn) {
  BenchResult result;
  result.note("something is missing");
  result.rows.push_back({{"part", "run"}, {"cost_ns", 2.0}});
  EXPECT_EQ(csvText(result),
            "part,cost_ns,note\n"
            "note,,something is missing\n"
            "run,2,\n");
}

TEST(BenchResult, TheTableNamesEveryTargetAndEveryNote) {
  const std::string table = targetTable(sample());
  EXPECT_THAT(table, HasSubstr("note: something is missing\n"));
  EXPECT_THAT(table, testing::ContainsRegex("cost \\[ns\\] +31.5  <= 35 +holds\n"));
  EXPECT_THAT(table, testing::ContainsRegex("error \\[voxel\\] +0.02  <= 0.015 +DOES NOT HOLD\n"));
  EXPECT_THAT(table, testing::EndsWith("1 of 2 targets hold\n"));
}

TEST(BenchResult, FiguresAreFoundByTheirKey) {
  const BenchRow row = sample().rows[0];
  EXPECT_EQ(figureOf(row, "n_ticks"), 5);
  EXPECT_EQ(textOf(row, "part"), "tick");
  EXPECT_EQ(textOf(row, "wall"), "");
  EXPECT_THROW(static_cast<void>(figureOf(row, "wall")), std::out_of_range);
  EXPECT_THROW(static_cast<void>(figureOf(row, "part")), std::bad_variant_access);
}

TEST(BenchResult, TheMachineIsNamedInALine) {
  EXPECT_THAT(machineInWords(), testing::ContainsRegex("[0-9]+ cores, [0-9.]+ GiB, Linux "));
}

TEST(BenchResult, RowsAreFoundByTheirFigures) {
  const BenchResult result = sample();
  EXPECT_EQ(rowsOf(result, "tick").size(), 1U);
  EXPECT_EQ(rowsOf(result, "tick", {{"n_ticks", 5.0}}).front(), &result.rows[0]);  // 5 is 5, whole or not
  EXPECT_TRUE(rowsOf(result, "tick", {{"n_ticks", std::int64_t{6}}}).empty());
  EXPECT_TRUE(rowsOf(result, "tick", {{"n_ticks", "5"}}).empty());   // no word is a number
  EXPECT_TRUE(rowsOf(result, "tick", {{"wall", "shell"}}).empty());  // which that row does not have
  EXPECT_EQ(rowsOf(result, "strokes", {{"wall", "shell, \"thin\""}, {"speed_m_per_s", 0.05}}).size(), 1U);
}

TEST(BenchResult, ANumberIsThereOrNot) {
  const BenchRow row = {{"n_ticks", std::int64_t{5}}, {"cost_ns", 2.5}, {"wall", "shell"}, {"error", std::nan("")}};
  EXPECT_EQ(numberIn(row, "n_ticks"), 5);
  EXPECT_EQ(numberIn(row, "cost_ns"), 2.5);
  for (const char* none : {"wall", "error", "speed"}) EXPECT_FALSE(numberIn(row, none)) << none;
  EXPECT_TRUE(hasAll(row, {{"n_ticks", 5.0}, {"wall", "shell"}}));
  EXPECT_TRUE(hasAll(row, {}));
  EXPECT_FALSE(hasAll(row, {{"n_ticks", 5.0}, {"wall", "ball"}}));
}

// Of 1, 4 and 2: 4 is the largest, 7 the sum, 1 the first, 2 the middle one.
TEST(BenchResult, APromiseIsHeldAgainstTheRowsItIsAbout) {
  BenchResult result;
  for (const double value : {1.0, 4.0, 2.0})
    result.rows.push_back({{"part", "a"}, {"speed_m_per_s", value}, {"x", value}});
  result.rows.push_back({{"part", "b"}, {"x", 100.0}});
  const auto valueOf = [&](double (*of)(const std::vector<double>&), double up_to) {
    EXPECT_TRUE(promise(result, {"name", 3, "a", {}, {"x"}, of, up_to}));
    return result.targets.back().value;
  };
  EXPECT_EQ(valueOf(largestOf, 0), 4);
  EXPECT_EQ(valueOf(sumOf, 0), 7);
  EXPECT_EQ(valueOf(firstOf, 0), 1);
  EXPECT_EQ(valueOf(medianOf, 0), 2);
  EXPECT_EQ(valueOf(sumOf, 2), 3);  // without the fastest
  EXPECT_EQ(result.targets.back().name, "name");
  EXPECT_EQ(result.targets.back().bound, 3);
  const std::size_t targets = result.targets.size();
  EXPECT_FALSE(promise(result, {"name", 3, "c", {}, {"x"}, sumOf}));
  EXPECT_EQ(result.targets.size(), targets);
  result.rows.push_back({{"part", "a"}, {"speed_m_per_s", 1.0}});  // a row without the figure
  EXPECT_EQ(valueOf(sumOf, 0), 7);
  result.rows.push_back({{"part", "a"}, {"speed_m_per_s", 1.0}, {"x", std::nan("")}});
  EXPECT_TRUE(std::isnan(valueOf(largestOf, 0)));
  result.rows.back().back().second = "a text";
  EXPECT_TRUE(std::isnan(valueOf(largestOf, 0)));
}

TEST(BenchResult, ThePageSaysWhereTheFiguresComeFromAndWhatHolds) {
  const std::string page = benchPage(sample(), {"Title", "As follows.", "a b\n", "servo.svg"});
  EXPECT_THAT(page, testing::StartsWith("# Title\n\nAs follows.\n"));
  for (const char* words :
       {"- machine: a machine, 2 cores\n", "- Vulkan device: none\n", "- commit: 0123456789\n",
        "- command: `palpate bench servo --seed 1`\n", "![Title](servo.svg)\n", "| cost [ns] | 31.5 | 35 | holds |\n",
        "| error [voxel] | 0.02 | 0.015 | **does not hold** |\n", "Note: something is missing\n", "```\na b\n```\n"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
}

TEST(BenchResult, AParagraphHasNoLineBreaks) {
  EXPECT_EQ(asParagraph("\na b\nc\nd e"), "a b c d e");
}

TEST(BenchResult, ThePageHasNoPictureWithoutAChart) {
  EXPECT_THAT(benchPage(sample(), {"Title", "As follows.", "a b\n", ""}), testing::Not(HasSubstr("![")));
}

}  // namespace bench_result_test
}  // namespace palpate
