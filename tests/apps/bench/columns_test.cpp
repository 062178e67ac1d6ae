// SPDX-License-Identifier: Apache-2.0
// One small table in each of its forms, as written out by hand.
#include "apps/bench/columns.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace palpate {
namespace columns_test {

struct Fall {
  std::string body;
  std::int64_t stones = 0;
  double depth_m = 0;
  Percentiles time_s;
  [[nodiscard]] double speed() const { return depth_m / time_s.p50; }
};

const Columns<Fall>& columns() {
  static const Columns<Fall> kColumns =
      joined(Columns<Fall>{{"body", &Fall::body, {"body", ""}},
                           {"stones", &Fall::stones, {"stones", ""}},
                           {"depth_m", &Fall::depth_m, {"depth", "m", 2}}},
             percentileColumns<Fall>("time", "s", &Fall::time_s,
                                     {{"median", &Percentiles::p50, {"time", "s", 3}}, {"max", &Percentiles::max}}),
             Columns<Fall>{{"speed_m_per_s", [](const Fall& fall) { return fall.speed(); }, {"speed", "m/s"}}});
  return kColumns;
}

Percentiles times(double median, double max) {
  Percentiles p;
  p.p50 = median;
  p.max = max;
  return p;
}

BenchResult sample() {
  BenchResult result;
  result.bench = "falls";
  const Fall falls[] = {{"earth", 3, 20, times(2, 2.5)}, {"moon", 12, 1.625, times(std::nan(""), 4)}};
  for (const Fall& fall : falls) {
    addFigures(result.rows.emplace_back(BenchRow{{"part", "fall"}}), columns(), fall);
  }
  result.rows.push_back({{"part", "fall"}, {"body", "mars"}, {"stones", std::int64_t{7}}});
  return result;
}

Table table() {
  return {{"fall"}, shown(columns())};
}

TEST(Columns, OfARowAreItsKeysAndFigures) {
  const BenchRow expected = {{"part", "fall"},       {"body", "earth"},      {"stones", std::int64_t{3}},
                             {"depth_m", 20.0},      {"time_median_s", 2.0}, {"time_max_s", 2.5},
                             {"speed_m_per_s", 10.0}};
  EXPECT_EQ(sample().rows[0], expected);
}

TEST(Columns, MakeTheTable) {
  EXPECT_EQ(tableText(sample(), table()),
            "body  stones depth  time speed\n"
            "                 m     s   m/s\n"
            "earth      3 20.00 2.000    10\n"
            "moon      12  1.62     -     -\n"  // a dash: there is none; 1.625 is rounded to even
            "mars       7\n");                  // a blank: that row has no such figure
}

TEST(Columns, MakeJson) {
  const std::string json = jsonText(sample());
  EXPECT_THAT(json, testing::HasSubstr(
                        "{\"part\":\"fall\",\"body\":\"moon\",\"stones\":12,\"depth_m\":1.625,\"time_median_s\":null,"
                        "\"time_max_s\":4.0,\"speed_m_per_s\":null},\n"
                        "{\"part\":\"fall\",\"body\":\"mars\",\"stones\":7}\n"));
}

TEST(Columns, MakeCsv) {
  EXPECT_EQ(csvText(sample()),
            "part,body,stones,depth_m,time_median_s,time_max_s,speed_m_per_s\n"
            "fall,earth,3,20,2,2.5,10\n"
            "fall,moon,12,1.625,,4,\n"
            "fall,mars,7,,,,\n");
}

TEST(Columns, MakeThePage) {
  const std::string page = benchPage(sample(), {"Falls", "Of stones.", tableText(sample(), table()), ""});
  EXPECT_THAT(page, testing::EndsWith("## Figures\n\n```\n"
                                      "body  stones depth  time speed\n"
                                      "                 m     s   m/s\n"
                                      "earth      3 20.00 2.000    10\n"
                                      "moon      12  1.62     -     -\n"
                                      "mars       7\n"
                                      "```\n"));
}

TEST(Columns, OfATableMayBeMadeOfTheRow) {
  const Table words = {
      {"fall"},
      {{"", [](const BenchRow& row) { return textOf(row, "body") + "!"; }, {"", ""}}, {"stones", nullptr, {"n", ""}}}};
  EXPECT_EQ(tableText(sample(), words),
            "        n\n"
            "earth!  3\n"
            "moon!  12\n"
            "mars!   7\n");
}

TEST(Columns, ATitleBeginsANewHead) {
  Table titled = {{"fall"}, {{"body", nullptr, {"body", ""}}}};
  titled.title = [](const BenchRow& row) { return figureOf(row, "stones") < 10 ? "few" : "many"; };
  EXPECT_EQ(tableText(sample(), titled),
            "few\nbody\nearth\n"
            "\nmany\nbody\nmoon\n"
            "\nfew\nbody\nmars\n");
}

TEST(Columns, OfRowsThatAreNotThereMakeNoTable) {
  EXPECT_EQ(tableText(sample(), {{"rise"}, shown(columns())}), "");
  EXPECT_EQ(tableText(BenchResult{}, table()), "");
}

TEST(Columns, ACellIsADashWhereAFigureIsNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const BenchRow row = {{"a", inf}, {"b", std::nan("")}, {"c", 0.5}, {"d", std::int64_t{1234567}}};
  EXPECT_EQ(cellText(row, "a", 4), "   -");
  EXPECT_EQ(cellText(row, "b", -4), "-   ");
  EXPECT_EQ(cellText(row, "c", 4), " 0.5");
  EXPECT_EQ(cellText(row, "c", 6, 3), " 0.500");
  EXPECT_EQ(cellText(row, "d", 9, 0), "  1234567");
  EXPECT_EQ(cellText(row, "nothing", 3), "   ");
}

TEST(LineByLine, CellsOfAName) {
  LineByLine lines;
  EXPECT_EQ(lines.text(), "");
  for (const auto& [name, cell] : {std::pair("b", " 1"), {"a", " 2"}, {"b", " 3"}}) lines.add(name, cell);
  EXPECT_EQ(lines.text(), "b 1 3\na 2\n");
}

}  // namespace columns_test
}  // namespace palpate
