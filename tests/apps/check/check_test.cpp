// SPDX-License-Identifier: Apache-2.0
// The frame of checks: what counts as a difference, what breaks a promise, and what is told.
#include "apps/check/check.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace check_test {

using testing::HasSubstr;
using testing::Not;

Check named(const char* what, const char* part = "") {
  Check check;
  check.name = "filter";
  check.what = what;
  check.part = part;
  check.volume = "phantom:box";
  return check;
}

TEST(Check, OfNothingDoesNotHold) {
  EXPECT_FALSE(Check{}.holds());
  EXPECT_FALSE(allHold({}));
}

TEST(Check, SeesEveryBit) {
  Check check;
  check.compare({0, 0, 0}, "density", 1, 1);
  EXPECT_TRUE(check.holds());
  check.compare({1, 2, 3}, "density", 0.0F, -0.0F);  // next to each other
  EXPECT_FALSE(check.holds());
  EXPECT_EQ(check.compared, 2U);
  EXPECT_EQ(check.differing, 1U);
  EXPECT_EQ(check.broken, 1U);
  EXPECT_EQ(check.largest_ulp, 1U);
  EXPECT_EQ(check.voxel, Vec3i(1, 2, 3));
}

TEST(Check, TellsTheWorst) {
  Check check;
  check.bound_ulp = 2;
  check.compare({1, 0, 0}, "gradient_i", 1, std::nextafter(1.0F, 2.0F));
  EXPECT_TRUE(check.holds());
  check.compare({2, 0, 0}, "gradient_j", 2, 1);
  check.compare({3, 0, 0}, "gradient_k", 1, std::nextafter(1.0F, 2.0F));
  EXPECT_FALSE(check.holds());
  EXPECT_EQ(check.differing, 3U);
  EXPECT_EQ(check.broken, 1U);
  EXPECT_EQ(check.largest_ulp, 1U << 23U);
  EXPECT_EQ(check.voxel, Vec3i(2, 0, 0));
  EXPECT_EQ(check.component, "gradient_j");
  EXPECT_EQ(check.gpu_value, 2);
  EXPECT_EQ(check.cpu_value, 1);
  check.compare({4, 0, 0}, "density", 2, 1);  // as far apart: the first is told
  EXPECT_EQ(check.voxel, Vec3i(2, 0, 0));
  Check at_its_bound;
  at_its_bound.bound_ulp = 1;
  at_its_bound.compare({0, 0, 0}, "density", 1, std::nextafter(1.0F, 2.0F));
  EXPECT_TRUE(at_its_bound.holds());
}

TEST(Check, KeepsToABoundOfEachValuesOwn) {
  Check check;
  check.reason = "for a test";
  check.compareWithin({1, 0, 0}, "density", 1, 1.25F, 0.5);
  check.compareWithin({2, 0, 0}, "density", 1, 1.125F, 1);
  EXPECT_TRUE(check.holds());
  EXPECT_EQ(check.differing, 2U);
  EXPECT_DOUBLE_EQ(check.largest_share, 0.5);
  EXPECT_EQ(check.voxel, Vec3i(1, 0, 0));
  check.compareWithin({3, 0, 0}, "density", 1, 1.25F, 0.25);  // just within
  EXPECT_TRUE(check.holds());
  EXPECT_DOUBLE_EQ(check.largest_share, 1);
  EXPECT_EQ(check.voxel, Vec3i(3, 0, 0));
  EXPECT_EQ(check.largest_ulp, 1U << 21U);  // a quarter of the binade from 1 to 2
  check.compareWithin({4, 0, 0}, "density", 1, 1.25F, 0.24);
  check.compareWithin({5, 0, 0}, "density", 1, 9, 0.24);
  EXPECT_FALSE(check.holds());
  EXPECT_EQ(check.broken, 2U);
  EXPECT_EQ(check.voxel, Vec3i(4, 0, 0));  // the first
}

// The smallest of differences is one: of the two zeros, which are no distance apart, and of neighbours.
TEST(Check, KeepsToABoundOfNothing) {
  Check check;
  check.reason = "for a test";
  check.compareWithin({1, 2, 3}, "density", 0.0F, -0.0F, 0);
  EXPECT_TRUE(check.holds());
  EXPECT_EQ(check.differing, 1U);
  EXPECT_EQ(check.largest_share, 0);
  EXPECT_EQ(check.voxel, Vec3i(1, 2, 3));
  EXPECT_EQ(check.component, "density");
  check.compareWithin({4, 0, 0}, "density", 0.0F, -0.0F, 0);
  EXPECT_EQ(check.voxel, Vec3i(1, 2, 3));  // no worse than the first
  EXPECT_EQ(check.differing, 2U);
}

TEST(Check, SaysWhatWasPromised) {
  Check check;
  EXPECT_EQ(promiseWords(check), "0 differing bits");
  check.bound_ulp = 1;
  EXPECT_EQ(promiseWords(check), "1 ULP");
  check.finite = true;
  EXPECT_EQ(promiseWords(check), "1 ULP and finite numbers");
  check.reason = "why";
  EXPECT_EQ(promiseWords(check), "a bound of each value's own and finite numbers");
}

TEST(Check, TakesNoNanForANumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Check bits;
  bits.compare({0, 0, 0}, "density", nan, 1);
  EXPECT_FALSE(bits.holds());
  Check bounded;
  bounded.compareWithin({0, 0, 0}, "density", nan, 1, 1e30);
  EXPECT_FALSE(bounded.holds());
  Check unbounded;
  unbounded.compareWithin({0, 0, 0}, "density", 2, 1, nan);
  EXPECT_FALSE(unbounded.holds());
  Check same;
  same.compareWithin({0, 0, 0}, "density", nan, nan, 0);
  EXPECT_TRUE(same.holds());
}

// Where finite numbers are promised, both sides' agreeing on none is no agreement.
TEST(Check, MissesFiniteNumbersWherePromised) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::array<Check, 2> checks = {named("bits"), named("bounded")};
  for (Check& check : checks) check.finite = true;
  checks[1].reason = "because";
  checks[0].compare({0, 0, 0}, "density", 1, 1);
  checks[1].compareWithin({0, 0, 0}, "density", 1, 1.5F, 1);
  EXPECT_TRUE(allHold(checks));
  checks[0].compare({3, 2, 1}, "density", inf, inf);
  checks[1].compareWithin({3, 2, 1}, "density", nan, nan, 1);
  for (const Check& check : checks) {
    EXPECT_FALSE(check.holds());
    EXPECT_EQ(check.compared, 2U);
    EXPECT_EQ(check.broken, 1U);
    EXPECT_EQ(check.not_finite, 1U);
    EXPECT_EQ(check.voxel, Vec3i(3, 2, 1));
  }
  EXPECT_EQ(checks[0].differing, 0U);
  EXPECT_THAT(checkTable(checks), HasSubstr("1 values break the promise of 0 differing bits and finite numbers"));
  EXPECT_EQ(nlohmann::json::parse(checkJson(checks, "filters", "abc"))["checks"][0]["not_finite"], 1);
}

// Parts of one chain share a line; what is broken has one of its own; a reason is said once.
TEST(Check, TableSumsPartsUp) {
  std::array<Check, 3> checks = {named("gaussian:1", "step 1 of 2"), named("gaussian:1", "step 2 of 2"),
                                 named("median:1")};
  checks[0].compare({0, 0, 0}, "density", 1, 1);
  checks[1].reason = "because";
  checks[1].compareWithin({0, 0, 0}, "density", 1, 1.5F, 1);
  checks[2].compare({0, 0, 0}, "density", 1, 1);
  std::string table = checkTable(checks);
  EXPECT_THAT(table, testing::ContainsRegex("\n  yes +filter +gaussian:1 +2 +1 +0.5 bound "));
  EXPECT_THAT(table, testing::ContainsRegex("\n  yes +filter +median:1 +1 +0 +0 ULP "));
  EXPECT_THAT(table, HasSubstr("because"));
  EXPECT_THAT(table, HasSubstr("3 of 3 checks hold\n"));
  checks[2].compare({4, 5, 6}, "density", 1, 2);
  table = checkTable(checks);
  EXPECT_THAT(table, testing::ContainsRegex("\n  NO +filter +median:1 "));
  EXPECT_THAT(table, HasSubstr("worst at voxel 4,5,6 density: GPU 1, CPU 2"));
  EXPECT_THAT(table, HasSubstr("2 of 3 checks hold: the promise is BROKEN\n"));
}

struct Told {
  const char *name, *what, *part, *volume;
  std::uint64_t compared, differing, broken;
  std::uint32_t largest_ulp;
};
Check told(const Told& figures) {
  Check check = named(figures.what, figures.part);
  check.name = figures.name;
  check.volume = figures.volume;
  check.compared = figures.compared;
  check.differing = figures.differing;
  check.broken = figures.broken;
  check.largest_ulp = figures.largest_ulp;
  check.voxel = {3, 1, 2};
  check.component = "density";
  check.gpu_value = 1.5F;
  check.cpu_value = 2.5F;
  return check;
}

// Written down by hand. Only parts of the same check on the same volume share a line.
TEST(Check, TableOfManyChecks) {
  std::vector<Check> checks = {told({"filter", "gaussian:1", "step 1 of 2", "a.nrrd", 10, 3, 0, 9}),
                               told({"filter", "gaussian:1", "step 2 of 2", "a.nrrd", 20, 7, 2, 4}),
                               told({"edits", "gaussian:1", "step 1 of 2", "a.nrrd", 40, 1, 0, 4}),
                               told({"edits", "median:1", "step 1 of 2", "a.nrrd", 50, 2, 0, 6}),
                               told({"edits", "median:1", "step 1 of 2", "b.nrrd", 60, 0, 0, 0}),
                               told({"edits", "median:1", "", "b.nrrd", 70, 0, 0, 0}),
                               told({"edits", "median:1", "step 1 of 2", "b.nrrd", 75, 0, 0, 0}),
                               told({"edits", "median:1", "", "b.nrrd", 80, 5, 1, 7})};
  checks[0].reason = "because";
  checks[0].largest_share = 0.75;
  checks[0].gpu_seconds = 0.25;
  checks[0].cpu_seconds = 0.5;
  checks[1].reason = "therefore";
  checks[1].largest_share = 0.5;
  checks[1].gpu_seconds = 1;
  checks[1].cpu_seconds = 2;
  checks[2].gpu_seconds = 0.5;
  checks[2].cpu_seconds = 0.25;
  checks[2].bound_ulp = 5;
  checks[3].bound_ulp = 6;
  checks[7].bound_ulp = 6;
  EXPECT_EQ(checkTable(checks),
            R"(  holds  check   what           values differing    largest  GPU [s]  CPU [s]
a.nrrd
  NO     filter  gaussian:1         30        10 0.75 bound    1.250    2.500
         step 2 of 2: 2 values break the promise of a bound of each value's own; worst at voxel 3,1,2 density: GPU 1.5, CPU 2.5
  yes    edits   gaussian:1         40         1      4 ULP    0.500    0.250
  yes    edits   median:1           50         2      6 ULP    0.000    0.000
b.nrrd
  yes    edits   median:1           60         0      0 ULP    0.000    0.000
  yes    edits   median:1           70         0      0 ULP    0.000    0.000
  yes    edits   median:1           75         0      0 ULP    0.000    0.000
  NO     edits   median:1           80         5      7 ULP    0.000    0.000
         1 values break the promise of 6 ULP; worst at voxel 3,1,2 density: GPU 1.5, CPU 2.5
Promised are finite densities and 0 differing bits; but
  because; but
  therefore.
6 of 8 checks hold: the promise is BROKEN
)");
}

// Columns are as wide as their headings at least; a reason that all share is said once.
TEST(Check, TableOfShortWords) {
  std::vector<Check> checks = {told({"ab", "cd", "", "v", 1, 0, 0, 0})};
  EXPECT_EQ(checkTable(checks),
            "  holds  check  what     values differing    largest  GPU [s]  CPU [s]\nv\n"
            "  yes    ab     cd            1         0      0 ULP    0.000    0.000\n"
            "Promised are finite densities and 0 differing bits.\n1 of 1 checks hold\n");
  checks[0].reason = "because";
  checks.push_back(checks[0]);
  EXPECT_THAT(checkTable(checks), testing::EndsWith("0 differing bits; but\n  because.\n2 of 2 checks hold\n"));
}

TEST(Check, JsonHasEveryFigure) {
  std::vector<Check> checks = {told({"filter", "gaussian:1", "step 1 of 2", "a.nrrd", 10, 3, 2, 9})};
  checks[0].device = "a device";
  checks[0].not_finite = 1;
  checks[0].bound_ulp = 5;
  checks[0].gpu_seconds = 0.25;
  checks[0].cpu_seconds = 0.5;
  EXPECT_EQ(checkJson(checks, "filters", "abc"), R"({
  "check": "filters",
  "commit": "abc",
  "holds": false,
  "checks": [
    {
      "check": "filter",
      "what": "gaussian:1",
      "part": "step 1 of 2",
      "volume": "a.nrrd",
      "vulkan_device": "a device",
      "compared": 10,
      "differing": 3,
      "broken": 2,
      "not_finite": 1,
      "largest_ulp": 9,
      "bound_ulp": 5,
      "worst_at_voxel": [
        3,
        1,
        2
      ],
      "worst_component": "density",
      "worst_gpu": 1.5,
      "worst_cpu": 2.5,
      "holds": false,
      "gpu_s": 0.25,
      "cpu_s": 0.5
    }
  ]
}
)");
  checks[0].reason = "because";
  checks[0].largest_share = 0.75;
  const auto row = nlohmann::json::parse(checkJson(checks, "filters", "abc"))["checks"][0];
  EXPECT_EQ(row["largest_share_of_bound"], 0.75);
  EXPECT_EQ(row["reason"], "because");
  EXPECT_FALSE(row.contains("bound_ulp"));
}

TEST(Check, JsonHasEveryCheck) {
  std::array<Check, 2> checks = {named("gaussian:1", "step 1 of 2"), named("bilateral:1:range=3")};
  checks[0].compare({0, 0, 0}, "density", 1, 1);
  checks[1].reason = "because";
  checks[1].compareWithin({1, 2, 3}, "density", std::numeric_limits<float>::infinity(), 1, 1);
  const auto json = nlohmann::json::parse(checkJson(checks, "filters", "abc"));
  EXPECT_EQ(json["check"], "filters");
  EXPECT_EQ(json["commit"], "abc");
  EXPECT_EQ(json["holds"], false);
  ASSERT_EQ(json["checks"].size(), 2U);
  EXPECT_EQ(json["checks"][0]["holds"], true);
  EXPECT_EQ(json["checks"][0]["bound_ulp"], 0);
  EXPECT_EQ(json["checks"][0]["part"], "step 1 of 2");
  EXPECT_EQ(json["checks"][1]["reason"], "because");
  EXPECT_EQ(json["checks"][1]["worst_at_voxel"], nlohmann::json({1, 2, 3}));
  EXPECT_EQ(json["checks"][1]["worst_gpu"], "inf");
}

using Limits = std::numeric_limits<float>;
constexpr std::uint32_t kNeverEqual = 0xFFFFFFFFU;

TEST(UlpDistance, OfTheSameBitsIsZero) {
  for (const float x :
       {0.0F, -0.0F, 1.0F, -1e30F, Limits::denorm_min(), Limits::max(), Limits::infinity(), Limits::quiet_NaN()}) {
    EXPECT_EQ(ulpDistance(x, x), 0U) << x;
  }
}

TEST(UlpDistance, OfNeighboursIsOne) {
  for (const float x :
       {1.0F, 2.0F, 0.99999994F, 1e-30F, 1e30F, -1.0F, -1e-30F, Limits::denorm_min(), Limits::min(), -Limits::min()}) {
    const float next = std::nextafter(x, Limits::infinity());
    EXPECT_EQ(ulpDistance(x, next), 1U) << x;
    EXPECT_EQ(ulpDistance(next, x), 1U) << x;
  }
}

TEST(UlpDistance, CountsTheFloatsBetween) {
  EXPECT_EQ(ulpDistance(1, 2), 1U << 23U);  // 2^23 floats in a binade
  EXPECT_EQ(ulpDistance(-1, -2), 1U << 23U);
  EXPECT_EQ(ulpDistance(1, 4), 1U << 24U);
  EXPECT_EQ(ulpDistance(Limits::denorm_min(), Limits::min()), (1U << 23U) - 1);
}

// -0 and +0 have different bits, so between -x and x there is one step more than twice the way to zero.
TEST(UlpDistance, GoesThroughZero) {
  EXPECT_EQ(ulpDistance(-0.0F, 0.0F), 1U);
  EXPECT_EQ(ulpDistance(0.0F, Limits::denorm_min()), 1U);
  EXPECT_EQ(ulpDistance(-0.0F, -Limits::denorm_min()), 1U);
  EXPECT_EQ(ulpDistance(-Limits::denorm_min(), Limits::denorm_min()), 3U);
  EXPECT_EQ(ulpDistance(-1, 1), 2 * 0x3F800000U + 1);
}

TEST(UlpDistance, ReachesInfinity) {
  EXPECT_EQ(ulpDistance(Limits::max(), Limits::infinity()), 1U);
  EXPECT_EQ(ulpDistance(-Limits::infinity(), Limits::infinity()), 2 * 0x7F800000U + 1);
  EXPECT_LT(ulpDistance(-Limits::infinity(), Limits::infinity()), kNeverEqual);
}

TEST(UlpDistance, ToAnotherNanIsTheLargest) {
  for (const float x : {0.0F, 1.0F, -1.0F, Limits::infinity(), -Limits::quiet_NaN()}) {
    EXPECT_EQ(ulpDistance(x, Limits::quiet_NaN()), kNeverEqual);
    EXPECT_EQ(ulpDistance(Limits::quiet_NaN(), x), kNeverEqual);
  }
}

}  // namespace check_test
}  // namespace palpate
