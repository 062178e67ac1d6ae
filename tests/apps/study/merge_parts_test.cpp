// SPDX-License-Identifier: Apache-2.0
// Parts are made up here; tests/apps/palpate/error_studies_test.cpp joins parts that the program measured.
#include "apps/study/merge_parts.hpp"

#include <algorithm>
#include <functional>

#include <gmock/gmock.h>

#include "apps/study/study_analysis.hpp"
#include "base/error.hpp"

namespace palpate {
namespace merge_parts_test {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kCells = 11;

BenchRow shardRow(std::int64_t number, std::int64_t of) {
  return {{"part", "shard"},         {"shard", number}, {"shards", of},       {"quick", "yes"},
          {"seed", std::int64_t{1}}, {"cells", kCells}, {"studies", "servo"}, {"machine", "a machine"}};
}

// A cell of the servo study: it is on a front, and one is left out.
BenchRow cellRow(std::int64_t cell, std::int64_t shard) {
  BenchRow row = {{"part", "servo"},    {"algorithm", cell == 3 ? "hri" : "avila"},
                  {"n_ticks", cell},    {"speed_m_per_s", 0.1},
                  {"noise_voxel", 0.0}, {"depth_voxel", 1.0},
                  {"radius", "20 mm"},  {"fall_throughs", std::int64_t{0}},
                  {"cell", cell},       {"shard", shard}};
  if (cell == 7) {
    row.emplace_back("left_out", "it is not installed");
    return row;
  }
  row.emplace_back("vhip_error_p99_voxel", 1.0 / static_cast<double>(cell + 1));
  row.emplace_back("errors_repeat", "yes");
  row.emplace_back("cost_ns", 10.0 * static_cast<double>(cell + 1));
  return row;
}

BenchPart partOf(std::int64_t number, std::int64_t of, const std::string& machine = "a machine") {
  BenchResult result;
  result.bench = "error";
  result.commit = "0123";
  result.machine = machine;
  result.vulkan_device = "llvmpipe";
  result.command = "palpate bench error --quick --study servo --seed 1";
  if (of > 1) result.command += " --shard " + std::to_string(number) + "/" + std::to_string(of);
  result.rows.push_back(shardRow(number, of));
  for (std::int64_t cell = number - 1; cell < kCells; cell += of) result.rows.push_back(cellRow(cell, number));
  analyse(result);
  return {"part" + std::to_string(number) + ".json", result};
}

std::vector<BenchPart> partsOf(std::int64_t of) {
  std::vector<BenchPart> parts;
  for (std::int64_t number = 1; number <= of; ++number) parts.push_back(partOf(number, of));
  return parts;
}

// Without what a shard adds: its row, and its number in the rows of cells.
std::string withoutShards(BenchResult result) {
  std::erase_if(result.rows, [](const BenchRow& row) { return textOf(row, "part") == "shard"; });
  for (BenchRow& row : result.rows) std::erase_if(row, [](const auto& cell) { return cell.first == "shard"; });
  return jsonText(result);
}

TEST(MergeParts, JoinedPartsAreWhatOneRunWouldHaveBeen) {
  const std::string whole = withoutShards(partOf(1, 1).result);
  for (const std::int64_t of : {1, 2, 3, 7, 11, 20}) {  // of 20 shards some have no cell
    std::vector<BenchPart> parts = partsOf(of);
    std::reverse(parts.begin(), parts.end());  // the order of the files does not count
    const BenchResult joined = mergeParts(parts);
    EXPECT_EQ(withoutShards(joined), whole) << of << " shards";
    EXPECT_EQ(rowsOf(joined, "shard").size(), static_cast<std::size_t>(of));
  }
}

TEST(MergeParts, TheMachineOfEachPartIsNamedWhereTheyDiffer) {
  const BenchResult joined = mergeParts({partOf(1, 2, "a machine"), partOf(2, 2, "another")});
  EXPECT_EQ(joined.machine, "shard 1: a machine; shard 2: another");
  EXPECT_EQ(joined.vulkan_device, "llvmpipe");
}

// A part that was stopped lacks two of its cells.
TEST(MergeParts, WhatAStoppedPartLacksIsSaid) {
  std::vector<BenchPart> parts = partsOf(2);
  std::erase_if(parts[1].result.rows,
                [](const BenchRow& row) { return textOf(row, "part") == "servo" && figureOf(row, "cell") >= 7; });
  const BenchResult joined = mergeParts(parts);
  const BenchRows notes = rowsOf(joined, "note");
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(textOf(*notes[0], "note"), HasSubstr("2 of 11 cells are missing"));
}

struct Change {
  const char* name;
  std::function<void(std::vector<BenchPart>&)> change;
  const char* file;
  const char* reason;
};

BenchFigure& figureIn(BenchRow& row, const std::string& key) {
  return std::ranges::find(row, key, [](const auto& cell) { return cell.first; })->second;
}

const Change kChanges[] = {
    {"Commit", [](auto& parts) { parts[1].result.commit = "4567"; }, "part2.json", "commit is '4567'"},
    {"Bench", [](auto& parts) { parts[2].result.bench = "servo"; }, "part3.json", "bench is 'servo'"},
    {"Quick", [](auto& parts) { parts[2].result.command = "palpate bench error --study servo --seed 1 --shard 3/3"; },
     "part3.json", "command without --shard"},
    {"Seed",
     [](auto& parts) { parts[1].result.command = "palpate bench error --quick --study servo --seed 2 --shard 2/3"; },
     "part2.json", "command without --shard"},
    {"Studies", [](auto& parts) { parts[1].result.command = "palpate bench error --quick --seed 1 --shard 2/3"; },
     "part2.json", "command without --shard"},
    {"Twice", [](auto& parts) { parts[2] = parts[1]; }, "part2.json", "shard 2, as part2.json is"},
    {"Missing", [](auto& parts) { parts.erase(parts.begin()); }, "part2.json", "of its 3 shards 1 is missing"},
    {"MissingTwo", [](auto& parts) { parts.erase(parts.begin() + 1, parts.end()); }, "part1.json",
     "of its 3 shards 2, 3 are missing"},
    {"OtherCount", [](auto& parts) { parts[1] = partOf(2, 4); }, "part2.json", "number of shards is '4'"},
    {"OtherCells", [](auto& parts) { figureIn(parts[1].result.rows[0], "cells") = std::int64_t{12}; }, "part2.json",
     "number of cells is '12'"},
    {"NoShard", [](auto& parts) { parts[1].result.rows.erase(parts[1].result.rows.begin()); }, "part2.json",
     "no shard of a bench"},
    {"Joined", [](auto& parts) { parts[1].result.rows.push_back(shardRow(3, 3)); }, "part2.json", "joined already"},
    {"NumberIsText", [](auto& parts) { figureIn(parts[1].result.rows[0], "shard") = "2"; }, "part2.json",
     "no whole number 'shard'"},
    {"NumberTooLarge", [](auto& parts) { figureIn(parts[1].result.rows[0], "shard") = std::int64_t{4}; }, "part2.json",
     "no whole number 'shard' from 1 to 3"},
    {"TooManyShards", [](auto& parts) { figureIn(parts[1].result.rows[0], "shards") = std::int64_t{1} << 40; },
     "part2.json", "no whole number 'shards'"},
    {"CellOfAnotherShard", [](auto& parts) { figureIn(parts[0].result.rows[1], "cell") = std::int64_t{1}; },
     "part1.json", "cell 1 is not of its shard"},
    {"CellTwice", [](auto& parts) { parts[0].result.rows.push_back(parts[0].result.rows[1]); }, "part1.json",
     "cell 0 is there twice"},
    {"CellBeyondTheList", [](auto& parts) { figureIn(parts[0].result.rows[1], "cell") = std::int64_t{12}; },
     "part1.json", "no whole number 'cell' from 0 to 10"},
};

class RefusedParts : public testing::TestWithParam<Change> {};

TEST_P(RefusedParts, InALineThatNamesTheFile) {
  std::vector<BenchPart> parts = partsOf(3);
  GetParam().change(parts);
  try {
    static_cast<void>(mergeParts(parts));
    ADD_FAILURE() << "accepted";
  } catch (const Error& refusal) {
    EXPECT_EQ(refusal.code(), Error::Code::kBadInput);
    EXPECT_EQ(refusal.input(), GetParam().file);
    EXPECT_THAT(refusal.what(), HasSubstr(GetParam().reason));
    EXPECT_THAT(refusal.what(), Not(HasSubstr("\n")));
  }
}

INSTANTIATE_TEST_SUITE_P(Each, RefusedParts, testing::ValuesIn(kChanges),
                         [](const auto& change) { return std::string(change.param.name); });

TEST(MergeParts, NothingIsRefused) {
  EXPECT_THROW(static_cast<void>(mergeParts({})), Error);
}

}  // namespace merge_parts_test
}  // namespace palpate
