// SPDX-License-Identifier: Apache-2.0
// The servo's study needs no Vulkan device and is quick; those of the others are in studies_test.cpp.
#include "apps/study/error_bench.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "apps/study/merge_parts.hpp"
#include "base/error.hpp"

namespace palpate {
namespace error_bench_test {

BenchResult measured(const Shard& shard) {
  Progress silent(nullptr);
  BenchResult result = runErrorBench({{.quick = true}, {"servo"}, shard}, silent);
  result.commit = "0123";
  result.command = "palpate bench error" + (shard.of > 1 ? shardWords(shard) : "");
  return result;
}

// Rows of cells and orders without costs and the numbers of shards, and the names of all targets.
std::string withoutCosts(BenchResult result) {
  std::erase_if(result.rows, [](const BenchRow& row) {
    return textOf(row, "part") == "shard" || textOf(row, "part") == "front" || textOf(row, "part") == "default";
  });
  for (BenchRow& row : result.rows) {
    std::erase_if(row, [](const auto& cell) { return cell.first == "shard" || cell.first.starts_with("cost_ns"); });
  }
  for (BenchTarget& target : result.targets) {
    if (target.name.find("cost less") != std::string::npos) target.value = 0;
  }
  return jsonText(result);
}

TEST(ErrorBench, AMergedResultIsThatOfOneRunButForCosts) {
  const BenchResult whole = measured({});
  std::vector<BenchPart> parts;
  for (int number = 1; number <= 3; ++number) parts.push_back({std::to_string(number), measured({number, 3})});
  const BenchResult joined = mergeParts(parts);
  EXPECT_EQ(withoutCosts(joined), withoutCosts(whole));
  EXPECT_GT(rowsOf(whole, "servo").size(), 50U);
}

TEST(ErrorBench, ACellHasItsCostsAndErrors) {
  const BenchResult result = measured({1, 8});
  const BenchRows rows = rowsOf(result, "servo");
  ASSERT_FALSE(rows.empty());
  for (const BenchRow* row : rows) {
    EXPECT_EQ(static_cast<int>(figureOf(*row, "cell")) % 8, 0);
    EXPECT_EQ(textOf(*row, "errors_repeat"), "yes");
    EXPECT_GT(figureOf(*row, "cost_ns"), 0);
    EXPECT_LE(figureOf(*row, "cost_ns_quartile_1"), figureOf(*row, "cost_ns"));
    EXPECT_LE(figureOf(*row, "cost_ns"), figureOf(*row, "cost_ns_quartile_3"));
    const std::string each = textOf(*row, "cost_ns_each");
    EXPECT_EQ(std::count(each.begin(), each.end(), ' '), 2) << each;  // of three rounds
  }
}

TEST(ErrorBench, AnUnknownStudyIsRefusedAtOnce) {
  Progress silent(nullptr);
  EXPECT_THROW(static_cast<void>(runErrorBench({{}, {"servo", "colours"}, {}}, silent)), Error);
}

}  // namespace error_bench_test
}  // namespace palpate
