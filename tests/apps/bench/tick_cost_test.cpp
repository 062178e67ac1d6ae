// SPDX-License-Identifier: Apache-2.0
// Times differ from machine to machine, so nothing here asserts one; what is asserted is what is timed, and in which
// order.
#include "apps/bench/tick_cost.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace palpate {
namespace tick_cost_test {

using testing::ElementsAre;

struct Log {
  std::vector<int> resets;  // who was begun with
  int ticks = 0;
  int nan_hips = 0;
  int outside_window = 0;
};

class Logger final : public Algorithm {
 public:
  Logger(int who, Log& log, double force_N) : who_(who), log_(log), force_N_(force_N) {}
  void reset(const Vec3&) noexcept override { log_.resets.push_back(who_); }
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    ++log_.ticks;
    log_.nan_hips += in.hip_W.hasNaN() ? 1 : 0;
    const Vec3 p_L = in.window->lattice.toIndex(in.hip_W);
    if (p_L.minCoeff() < 9 || p_L.maxCoeff() > 32 - 9) ++log_.outside_window;
    out = TickOutput{};
    out.force_W = Vec3::Constant(force_N_);
  }

 private:
  int who_;
  Log& log_;
  double force_N_;
};

std::vector<Entrant> loggers(Log& log, int count, double force_N = 1) {
  std::vector<Entrant> entrants;
  for (int i = 0; i < count; ++i) {
    entrants.push_back({"logger", i, "none", std::make_unique<Logger>(i, log, force_N), {}});
  }
  return entrants;
}

class Replay : public testing::Test {
 protected:
  BenchVolume volume_{"phantom:sphere?size=128x128x64"};
  ReplayPath path_{volume_, contactPath(volume_, {.ticks = 400})};
};

TEST_F(Replay, HasSeveralWindowsAndEachHoldsTheTool) {
  Log log;
  Logger logger(0, log, 1);
  EXPECT_GT(path_.replay_ns(logger), 0);
  EXPECT_GE(path_.windows(), 4U);  // 37 mm of way
  EXPECT_EQ(log.ticks, 400);
  EXPECT_EQ(log.outside_window, 0);
}

// A tick must wait for the force of the last one, the first of the slide for that of the approach: a force that is no
// number then shows in every HIP of the slide.
TEST_F(Replay, EachTickDependsOnTheLastForce) {
  Log log;
  Logger logger(0, log, std::numeric_limits<double>::quiet_NaN());
  EXPECT_GT(path_.replay_ns(logger), 0);
  EXPECT_EQ(log.nan_hips, static_cast<int>(path_.slideTicks()));
}

TEST_F(Replay, GoesRoundAllEntrantsBeginningWithAnotherEachTime) {
  Log log;
  auto entrants = loggers(log, 3);
  const auto costs = tickCosts(path_, entrants, {.repetitions = 3, .tick_replays = 2}, [](double) {});
  EXPECT_THAT(log.resets, ElementsAre(0, 1, 2,                    // warming up
                                      0, 1, 2, 1, 2, 0, 2, 0, 1,  // batches
                                      0, 1, 2, 1, 2, 0));         // single ticks
  ASSERT_EQ(costs.size(), 3U);
  for (const TickCost& cost : costs) {
    EXPECT_EQ(cost.batch_ns.size(), 3U);
    EXPECT_EQ(cost.fastest_ns.count, path_.slideTicks());
    EXPECT_EQ(cost.raw_ns.count, 2 * path_.slideTicks());
    EXPECT_LE(cost.fastest_ns.max, cost.raw_ns.max);
    EXPECT_LE(cost.fastest_ns.p50, cost.raw_ns.p50);
  }
}

TEST_F(Replay, StopsWhenProgressThrows) {
  Log log;
  auto entrants = loggers(log, 2);
  EXPECT_THROW(static_cast<void>(tickCosts(path_, entrants, {}, [](double) { throw std::runtime_error("stop"); })),
               std::runtime_error);
}

// Each figure another number, so that no column can have that of its neighbour.
TEST(CostColumns, AreTheFiguresOfTheirNames) {
  BenchRow row;
  addFigures(row, costColumns(), TickCost{{30, 10, 40, 20}, {1, 1, 0, 2, 3, 4}, {1, 5, 0, 6, 7, 8}});
  const BenchRow expected = {{"cost_ns", 20.0},         {"cost_quartile_1_ns", 10.0}, {"cost_quartile_3_ns", 30.0},
                             {"tick_median_ns", 1.0},   {"tick_p99_ns", 2.0},         {"tick_p999_ns", 3.0},
                             {"tick_max_ns", 4.0},      {"tick_raw_median_ns", 5.0},  {"tick_raw_p99_ns", 6.0},
                             {"tick_raw_p999_ns", 7.0}, {"tick_raw_max_ns", 8.0}};
  EXPECT_EQ(row, expected);
}

TEST(Spread, IsMedianAndQuartilesThatWereMeasured) {
  const Spread spread = spreadOf({8, 1, 3, 2, 100, 4, 5, 6});
  EXPECT_EQ(spread.low, 2);
  EXPECT_EQ(spread.median, 4);
  EXPECT_EQ(spread.high, 6);
}

}  // namespace tick_cost_test
}  // namespace palpate
