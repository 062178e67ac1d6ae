// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/result_file.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace result_file_test {

using testing::HasSubstr;

BenchResult sampleResult() {
  BenchResult result;
  result.bench = "error";
  result.commit = "0123456789";
  result.machine = "a machine, \"2\" cores\n";
  result.vulkan_device = "llvmpipe \xC3\xA4";
  result.command = "palpate bench error --seed 1";
  result.rows.push_back({{"part", "servo"}, {"n_ticks", std::int64_t{5}}, {"cost_ns", 31.0}, {"tiny", 5e-324}});
  result.rows.push_back({{"part", "servo"}, {"least", std::numeric_limits<std::int64_t>::min()}, {"zero", -0.0}});
  result.rows.push_back({});
  result.targets = {{"cost [ns]", 31.5, 35}, {"error [voxel]", 0.02, 0.015}};
  return result;
}

// The same JSON, and the same kind of figure: a whole double stays a double.
void expectSame(const BenchResult& again, const BenchResult& result) {
  EXPECT_EQ(jsonText(again), jsonText(result));
  ASSERT_EQ(again.rows.size(), result.rows.size());
  for (std::size_t i = 0; i < result.rows.size(); ++i) EXPECT_EQ(again.rows[i], result.rows[i]);
}

TEST(ResultFile, WhatIsWrittenIsReadAgain) {
  expectSame(benchResultFrom(jsonText(sampleResult()), "a.json"), sampleResult());
  expectSame(benchResultFrom(jsonText(BenchResult{}), "a.json"), BenchResult{});
}

// Doubles of random bits, but for those that are not finite.
TEST(ResultFile, FiguresKeepEveryBit) {
  std::mt19937_64 bits(1);
  BenchResult result;
  for (int i = 0; i < 20000; ++i) {
    double value = 0;
    const std::uint64_t word = bits();
    std::memcpy(&value, &word, sizeof value);
    if (!std::isfinite(value)) continue;
    result.rows.push_back({{"value", value}, {"count", static_cast<std::int64_t>(bits())}});
  }
  const BenchResult again = benchResultFrom(jsonText(result), "a.json");
  ASSERT_EQ(again.rows.size(), result.rows.size());
  for (std::size_t i = 0; i < result.rows.size(); ++i) ASSERT_EQ(again.rows[i], result.rows[i]);
}

TEST(ResultFile, AFigureThatWasNotFiniteIsNaN) {
  BenchResult result;
  result.rows.push_back({{"value", std::numeric_limits<double>::infinity()}});
  result.targets.push_back({"cost [ns]", std::nan(""), 35});
  const BenchResult again = benchResultFrom(jsonText(result), "a.json");
  EXPECT_TRUE(std::isnan(std::get<double>(again.rows[0][0].second)));
  EXPECT_TRUE(std::isnan(again.targets[0].value));
  EXPECT_FALSE(again.targets[0].holds());
}

// Whether a target holds is not taken from the file.
TEST(ResultFile, ATargetIsHeldAgainstItsBoundAnew) {
  std::string text = jsonText(sampleResult());
  const std::string lie = "\"bound\":0.015,\"holds\":false";
  ASSERT_NE(text.find(lie), std::string::npos);
  text.replace(text.find(lie), lie.size(), "\"bound\":0.015,\"holds\":true");
  EXPECT_FALSE(benchResultFrom(text, "a.json").targets[1].holds());
}

std::string refusalOf(const std::string& text) {
  try {
    static_cast<void>(benchResultFrom(text, "bad.json"));
  } catch (const Error& refusal) {
    EXPECT_EQ(refusal.code(), Error::Code::kBadInput);
    EXPECT_THAT(refusal.what(), HasSubstr("bad.json: "));
    EXPECT_THAT(refusal.what(), testing::Not(HasSubstr("\n")));
    return refusal.reason();
  }
  ADD_FAILURE() << "accepted: " << text;
  return "";
}

TEST(ResultFile, EveryCutIsRefused) {
  const std::string text = jsonText(sampleResult());
  for (std::size_t end = 0; end + 2 < text.size(); ++end) {  // the last bytes are "}\n"
    EXPECT_THAT(refusalOf(text.substr(0, end)), HasSubstr("damaged"));
  }
}

TEST(ResultFile, WhatIsNoResultIsRefusedWithItsPlace) {
  const std::string head = R"({"bench":"a","commit":"b","machine":"c","vulkan_device":"d","command":"e",)";
  EXPECT_THAT(refusalOf("[]"), HasSubstr("no result of a bench"));
  EXPECT_THAT(refusalOf("{}"), HasSubstr("no text 'bench'"));
  EXPECT_THAT(refusalOf(R"({"bench":3})"), HasSubstr("no text 'bench'"));
  EXPECT_THAT(refusalOf(head + R"("targets":[]})"), HasSubstr("no list 'rows'"));
  EXPECT_THAT(refusalOf(head + R"("rows":{},"targets":[]})"), HasSubstr("no list 'rows'"));
  EXPECT_THAT(refusalOf(head + R"("rows":[{},3],"targets":[]})"), HasSubstr("row 2 is no object"));
  EXPECT_THAT(refusalOf(head + R"("rows":[{"a":[1]}],"targets":[]})"), HasSubstr("'a' of row 1"));
  EXPECT_THAT(refusalOf(head + R"("rows":[{"a\n":true}],"targets":[]})"), HasSubstr("'a?' of row 1"));
  EXPECT_THAT(refusalOf(head + R"("rows":[]})"), HasSubstr("no list 'targets'"));
  EXPECT_THAT(refusalOf(head + R"("rows":[],"targets":[{"name":"n","value":"v","bound":1}]})"),
              HasSubstr("target 1 has no number 'value'"));
  EXPECT_THAT(refusalOf(head + R"("rows":[{"a":1e999}],"targets":[]})"), HasSubstr("damaged"));
  EXPECT_THAT(refusalOf(std::string(100'000, '[')), HasSubstr("damaged"));
  EXPECT_THAT(refusalOf("\xff\xfe"), HasSubstr("damaged"));
}

TEST(ResultFile, WholeNumbersBeyond64BitsAreDoubles) {
  const std::string text =
      R"({"bench":"a","commit":"b","machine":"c","vulkan_device":"d","command":"e","rows":[{"a":18446744073709551615}],"targets":[]})";
  EXPECT_EQ(std::get<double>(benchResultFrom(text, "a.json").rows[0][0].second), 18446744073709551615.0);
}

TEST(ResultFile, AFileThatIsNotThereOrNoFileIsRefused) {
  EXPECT_THROW(static_cast<void>(readBenchResult("/nowhere/a.json")), Error);
  try {
    static_cast<void>(readBenchResult(std::filesystem::temp_directory_path()));
    ADD_FAILURE();
  } catch (const Error& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("no plain file"));
  }
}

}  // namespace result_file_test
}  // namespace palpate
