// SPDX-License-Identifier: Apache-2.0
// A run of seconds: what it is made of, and its figures of correctness. No time is asserted.
#include "apps/bench/servo_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "apps/bench/entrants.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace servo_bench_test {

using testing::HasSubstr;

class ServoBench : public testing::Test {
 protected:
  static const BenchResult& result() {
    static const BenchResult kResult = [] {
      ServoBenchRequest request;
      request.volumes = {"phantom:sphere?size=64"};
      request.renewals = {1, 5};
      request.cost_ticks = 100;
      request.repetitions = 3;
      request.tick_replays = 2;
      request.error_ticks = 400;
      request.accuracy_ticks = 2000;  // long enough to meet a concave part of the knot
      request.strokes = 2;
      request.press_ticks = 200;
      request.press_seeds = 2;
      Progress progress;
      return runServoBench(request, progress);
    }();
    return kResult;
  }
  static const BenchRow& tick(const std::string& algorithm, int n) {
    return *rowsOf(result(), "tick", {{"algorithm", algorithm}, {"n_ticks", std::int64_t{n}}}).at(0);
  }
};

TEST_F(ServoBench, HasARowForEveryAlgorithmOfTheRegistry) {
  std::map<std::string, int> parts;
  for (const BenchRow& row : result().rows) ++parts[textOf(row, "part")];
  std::size_t left_out = 0;
  for (const BenchRow& row : result().rows) left_out += textOf(row, "note").starts_with("left out") ? 1 : 0;
  const int count = static_cast<int>(algorithms().size() - left_out);
  EXPECT_EQ(parts["tick"], 2 * count);
  EXPECT_EQ(parts["accuracy"], 2 * 2 * count);  // two knots
  EXPECT_EQ(parts["ratio"], count - 1);
  EXPECT_EQ(parts["strokes"], 4 * 6 * count);  // walls by speeds
  EXPECT_EQ(parts["harness"], 1);
  const auto renewing =
      static_cast<int>(std::count_if(algorithms().begin(), algorithms().end(),
                                     [](const AlgorithmEntry& entry) { return entry.traits.renews_planes; }));
  EXPECT_EQ(renewing, 3);
  EXPECT_EQ(parts["press"], 4 * (4 + 2) * (count + renewing));  // noises by depths, n = 1 and 5
  EXPECT_EQ(parts["speed"], (7 + 4) * (count + 7 * renewing));  // speeds, eight n
  EXPECT_EQ(parts["table"], 2 * 2 * 4);                         // noises by depths by the table's algorithms
}

TEST_F(ServoBench, NeedsNoVulkanDeviceAndNamesTheMachine) {
  EXPECT_EQ(result().bench, "servo");
  EXPECT_EQ(result().vulkan_device, "none");
  EXPECT_FALSE(result().machine.empty());
}

// The sag of trilinear interpolation over a sphere: h^2 / 8 times the sum of the second derivatives of the distance,
// 2 / R, so h^2 / (4 R); R = 0.7 * 31.5 = 22.05 voxels gives 0.01134 voxel at most. A Newton step of up to 0.02 voxel
// with a gradient that is wrong by less than 1 % (h^2 / (6 R^2) and the sag's) adds less than 0.0002.
TEST_F(ServoBench, FindsTheDefaultAlgorithmOnTheSphereAsTrueAsItIs) {
  const BenchRow& row = tick("hri", 1);
  EXPECT_LE(figureOf(row, "vhip_error_median_voxel"), 0.01154);
  EXPECT_GT(figureOf(row, "vhip_error_median_voxel"), 0.001);  // the sag is there: not the phantom itself was felt
  EXPECT_LE(figureOf(row, "vhip_error_p99_voxel"), 0.01154);
  EXPECT_EQ(figureOf(row, "fall_throughs"), 0);
  EXPECT_EQ(figureOf(row, "contact_ticks"), figureOf(row, "ticks"));
}

// A plane that lives five ticks and is found for a third of the way through them is up to 0.27 mm aside: on a sphere of
// 22.05 mm, 1 mm below, up to 0.73 degrees, and what a turning path aims wrong.
TEST_F(ServoBench, AnOlderPlaneIsWrongByTheWayOverTheRadius) {
  EXPECT_LT(figureOf(tick("hri", 1), "force_angle_p99_deg"), 0.1);
  EXPECT_GT(figureOf(tick("hri", 5), "force_angle_median_deg"), 0.15);
  EXPECT_LT(figureOf(tick("hri", 5), "force_angle_p99_deg"), 0.9);
}

// What is not there is null, and not drawn as if it were.
TEST_F(ServoBench, HaptizationHasNoVhipErrorAndNoErrorOfTheForce) {
  int rows = 0;
  for (const BenchRow& row : result().rows) {
    for (const auto& [key, figure] : row) {
      if (key != "vhip_error_median_voxel" && key != "force_error_p99_percent" && key != "force_off_max") continue;
      const bool none = textOf(row, "algorithm") == "haptization" || figureOf(row, "contact_ticks") == 0;
      EXPECT_EQ(std::isnan(std::get<double>(figure)), none) << key << " " << textOf(row, "algorithm");
      ++rows;
    }
  }
  EXPECT_GT(rows, 100);
  EXPECT_THAT(jsonText(result()), HasSubstr("\"vhip_error_median_voxel\":null"));
  const std::string chart = logChartSvg(servoCharts(result()));
  const std::size_t direction = chart.find("angle of the force, median");
  ASSERT_NE(direction, std::string::npos);
  EXPECT_THAT(chart.substr(direction), HasSubstr("haptization"));
  EXPECT_THAT(servoTable(result()), testing::ContainsRegex("haptization +1 +[0-9. ]+ +- +- +- +- "));
}

// Noise is in the samples, not in the truth: without any, hri's error is the sag of interpolation (radius 40 voxels,
// 1 / 160 of a voxel), with noise the surface that the samples hold is off by a good part of it: the mean of eight
// samples has a third to all of one's deviation.
TEST_F(ServoBench, NoiseIsInTheSamplesAndNotInTheTruth) {
  std::map<double, double> error_voxel;
  for (const BenchRow& row : result().rows) {
    if (textOf(row, "part") != "press" || textOf(row, "algorithm") != "hri" || figureOf(row, "n_ticks") != 1 ||
        figureOf(row, "depth_voxel") != 1 || textOf(row, "volume") != kBall20mm)
      continue;
    error_voxel[figureOf(row, "noise_voxel")] = figureOf(row, "vhip_error_median_voxel");
    EXPECT_EQ(figureOf(row, "seeds"), figureOf(row, "noise_voxel") == 0 ? 1 : 2);
  }
  ASSERT_EQ(error_voxel.size(), 4U);
  EXPECT_LE(error_voxel[0], 1.0 / 160 + 2e-4);
  double last = error_voxel[0];
  for (const double noise : {0.1, 0.25, 0.5}) {
    EXPECT_GT(error_voxel[noise], last);
    EXPECT_LT(error_voxel[noise], noise);
    last = error_voxel[noise];
  }
}

TEST_F(ServoBench, RecoveryStatesItsConditionsAndHasARowWhereItMatters) {
  int promised = 0, matters = 0;
  for (const BenchRow& row : result().rows) {
    if (textOf(row, "part") != "effects" || textOf(row, "algorithm") != "hri-paper") continue;
    EXPECT_EQ(figureOf(row, "depth_voxel"), 1);
    EXPECT_EQ(figureOf(row, "recovery_s"), kRecoveryTime_s);
    promised += figureOf(row, "n_ticks") == 20 && figureOf(row, "speed_m_per_s") == 0.02 ? 1 : 0;
    matters += figureOf(row, "n_ticks") == 50 && figureOf(row, "speed_m_per_s") == 0.1 ? 1 : 0;
  }
  EXPECT_EQ(promised, 2);
  EXPECT_EQ(matters, 2);
}

TEST_F(ServoBench, CostsAreThereAndOrdered) {
  for (const BenchRow& row : result().rows) {
    if (textOf(row, "part") != "tick") continue;
    EXPECT_GT(figureOf(row, "cost_ns"), 0);
    EXPECT_LE(figureOf(row, "cost_quartile_1_ns"), figureOf(row, "cost_ns"));
    EXPECT_LE(figureOf(row, "cost_ns"), figureOf(row, "cost_quartile_3_ns"));
    EXPECT_LE(figureOf(row, "tick_median_ns"), figureOf(row, "tick_p99_ns"));
    EXPECT_LE(figureOf(row, "tick_p999_ns"), figureOf(row, "tick_max_ns"));
    EXPECT_LE(figureOf(row, "tick_max_ns"), figureOf(row, "tick_raw_max_ns"));
    EXPECT_EQ(figureOf(row, "seed"), 1);
  }
}

// Of three repetitions the quartiles are the least and the largest. So a ratio within a repetition lies between the
// least cost over the other's largest, and the largest over the other's least.
TEST_F(ServoBench, RatiosAreOfTheCostsInTheSameRepetitions) {
  const BenchRow& hri = tick("hri", 5);
  for (const BenchRow* ratio : rowsOf(result(), "ratio")) {
    const std::string algorithm = textOf(*ratio, "algorithm");
    const BenchRow& its = tick(algorithm, 5);
    EXPECT_EQ(figureOf(*ratio, "n_ticks"), 5);
    const double least = figureOf(hri, "cost_quartile_1_ns") / figureOf(its, "cost_quartile_3_ns");
    const double most = figureOf(hri, "cost_quartile_3_ns") / figureOf(its, "cost_quartile_1_ns");
    EXPECT_LE(least, figureOf(*ratio, "hri_over_it_quartile_1")) << algorithm;
    EXPECT_LE(figureOf(*ratio, "hri_over_it_quartile_1"), figureOf(*ratio, "hri_over_it")) << algorithm;
    EXPECT_LE(figureOf(*ratio, "hri_over_it"), figureOf(*ratio, "hri_over_it_quartile_3")) << algorithm;
    EXPECT_LE(figureOf(*ratio, "hri_over_it_quartile_3"), most) << algorithm;
  }
}

// Two seeds where there is noise, one where there is none: as many ticks from each, and their sum in the row.
TEST_F(ServoBench, CountsOfSeveralSeedsAreTheirSum) {
  std::map<std::pair<std::string, double>, double> clean;  // ticks by volume and depth
  const auto place = [](const BenchRow& row) { return std::pair(textOf(row, "volume"), figureOf(row, "depth_voxel")); };
  for (const BenchRow* row : rowsOf(result(), "press", {{"noise_voxel", 0.0}})) {
    clean[place(*row)] = figureOf(*row, "ticks");
  }
  EXPECT_EQ(clean.size(), 4U + 2U);
  int rows = 0;
  for (const BenchRow* row : rowsOf(result(), "press")) {
    if (figureOf(*row, "noise_voxel") == 0) continue;
    EXPECT_EQ(figureOf(*row, "ticks"), 2 * clean[place(*row)]);
    ++rows;
  }
  EXPECT_GT(rows, 100);
}

TEST_F(ServoBench, TriesTheDepthsSpeedsAndAgesThatItSays) {
  using testing::UnorderedElementsAre;
  const auto values = [](const char* part, const char* volume, const char* key) {
    std::set<double> found;
    for (const BenchRow* row : rowsOf(result(), part, {{"volume", volume}, {"algorithm", "hri"}})) {
      found.insert(figureOf(*row, key));
    }
    return found;
  };
  EXPECT_THAT(values("press", kBall20mm, "depth_voxel"), UnorderedElementsAre(1, 4, 12, 24));
  EXPECT_THAT(values("press", kTubeOf8, "depth_voxel"), UnorderedElementsAre(1, 4));
  EXPECT_THAT(values("press", kBall20mm, "noise_voxel"), UnorderedElementsAre(0, 0.1, 0.25, 0.5));
  EXPECT_THAT(values("press", kBall20mm, "n_ticks"), UnorderedElementsAre(1, 5));
  // 2 mm deep both: the ball's voxels are 0.5 mm, the knot's 1 mm.
  EXPECT_THAT(values("speed", kBall20mm, "depth_voxel"), UnorderedElementsAre(4));
  EXPECT_THAT(values("speed", kTubeOf8, "depth_voxel"), UnorderedElementsAre(2));
  EXPECT_THAT(values("speed", kBall20mm, "speed_m_per_s"), UnorderedElementsAre(0.05, 0.1, 0.25, 0.5, 1, 1.5, 2));
  EXPECT_THAT(values("speed", kTubeOf8, "speed_m_per_s"), UnorderedElementsAre(0.05, 0.1, 0.25, 0.5));
  EXPECT_THAT(values("speed", kTubeOf8, "n_ticks"), UnorderedElementsAre(1, 2, 5, 10, 20, 50, 100, 1000));
  EXPECT_THAT(values("table", "phantom:sphere?size=64", "noise_voxel"), UnorderedElementsAre(0, 0.25));
  EXPECT_THAT(values("table", "phantom:sphere?size=64", "depth_voxel"), UnorderedElementsAre(1, 2));
  for (const BenchRow* row : rowsOf(result(), "strokes")) {
    EXPECT_EQ(figureOf(*row, "strokes") + figureOf(*row, "strokes_over_holes_in_samples"), 2);
    EXPECT_LE(figureOf(*row, "missed") + figureOf(*row, "lost"), figureOf(*row, "strokes"));
  }
}

// The rows of hri with recovery and without, on the condition of the targets.
TEST_F(ServoBench, RecoveryTargetsAreRatiosOfTheirRows) {
  const auto figure = [](const char* effects, const char* key) {
    const BenchRow like = {{"algorithm", "hri"}, {"effects", effects}, {"n_ticks", std::int64_t{20}}};
    return figureOf(*rowsOf(result(), "effects", like).at(0), key);
  };
  const auto target = [](const std::string& words) {
    return *std::find_if(result().targets.begin(), result().targets.end(),
                         [&](const BenchTarget& one) { return one.name.find(words) != std::string::npos; });
  };
  const BenchTarget mean = target("mean force differs by");
  EXPECT_DOUBLE_EQ(mean.value, std::abs(figure("recovery", "force_mean_N") / figure("none", "force_mean_N") - 1));
  EXPECT_EQ(mean.bound, 0.01);
  const BenchTarget jump = target("largest force jump per tick on concave regions");
  EXPECT_EQ(jump.bound, 0.1);
  const double on = figure("recovery", "force_jump_concave_max_N"), off = figure("none", "force_jump_concave_max_N");
  ASSERT_GT(off, 0) << "the short path meets a concave region";
  EXPECT_DOUBLE_EQ(jump.value, on / off);
}

TEST_F(ServoBench, TargetNamesAreStable) {
  std::vector<std::string> names;
  for (const BenchTarget& target : result().targets) names.push_back(target.name);
  const std::string jumps =
      "recovery on / off, largest force jump per tick on concave regions "
      "(hri, knot 128x128x64, n=20, 0.02 m/s, 1 voxel deep, 20 ms) [-]";
  EXPECT_THAT(
      names,
      testing::IsSupersetOf<std::string>(
          {"hri, tick without renewal [ns]", "hri, renewal every tick (n=1), median of the volumes [ns]",
           "hri, mean at n=5, median of the volumes [ns]", "hri, knot 128x128x64, n=1, median VHIP error [voxel]",
           "hri, knot 128x128x64, n=1, median force angle [degree]", "hri, knot 128x128x64, n=1, fall-throughs [-]",
           "hri, knot 128x128x64, n=5, median VHIP error [voxel]",
           "hri, knot 128x128x64, n=5, median force angle [degree]", "hri, knot 128x128x64, n=5, fall-throughs [-]",
           "hri, one-voxel shell up to 1 m/s, missed or lost contacts [-]",
           "hri, ball of 20 mm, voxels of 0.5 mm, 2 mm deep, up to 2 m/s, any n, force over K depth or its inverse [-]",
           "hri, ball of 20 mm, voxels of 0.5 mm, 2 mm deep, up to 2 m/s, any n, force angle [degree]",
           "hri, knot's tube of 8 voxels, 2 mm deep, up to 0.5 m/s, any n, force over K depth or its inverse [-]",
           "hri, knot's tube of 8 voxels, 2 mm deep, up to 0.5 m/s, any n, force angle [degree]",
           "hri, noise up to 0.5 voxel, 1 to 24 voxels deep, contacts lost [-]", jumps}));
}

TEST_F(ServoBench, SaysItAllOnTheTerminalAndInTheChart) {
  const std::string table = servoTable(result());
  for (const char* words :
       {"phantom:sphere?size=64 (cost and error)", "phantom:knot?size=128x128x64 (long path)", "hri-paper",
        "a tick that does nothing", "shell of 1 voxel", "noise 0.25 voxel, 24 voxels deep",
        "2 mm deep at 0.05, 0.1, 0.25, 0.5 m/s", "recovery time of 20 ms"}) {
    EXPECT_THAT(table, HasSubstr(words));
  }
  EXPECT_THAT(tableOne(result()), HasSubstr("sphere (64x64x64) today"));
  EXPECT_THAT(tableTrial(result()), testing::ContainsRegex("sphere.size=64 +0.25 +2 \\| +[0-9]"));
  const std::string chart = logChartSvg(servoCharts(result()));
  for (const char* words : {"<svg", "hri-paper", "n=5", "VHIP error", "angle of the force"}) {
    EXPECT_THAT(chart, HasSubstr(words));
  }
}

}  // namespace servo_bench_test
}  // namespace palpate
