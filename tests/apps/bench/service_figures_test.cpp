// SPDX-License-Identifier: Apache-2.0
// Figures of records that were made up, so that each is known beforehand.
#include "apps/bench/service_figures.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace service_figures_test {

constexpr std::int64_t kStart_ns = 1'000'000'000;
constexpr double kRate_hz = 1000;

std::int64_t at_ns(double after_start_ms) {
  return kStart_ns + std::llround(after_start_ms * 1e6);
}

// A hundred ticks of a millisecond, each 50 us late and (tick + 1) * 100 ns dear. Windows are published 0.4 ms before
// the ticks 0, 12, 22 and 33 first use them, with edits 1, 2, 3 and 4.
LoopResult madeUpRun() {
  LoopResult loop;
  loop.first_due_ns = kStart_ns;
  loop.ticks_skipped = 7;
  std::int64_t begin = 0;
  std::uint64_t version = 1;
  for (std::int64_t k = 0; k < 100; ++k) {
    if (k == 12 || k == 22 || k == 33) {
      begin = k;
      ++version;
    }
    TickRecord& tick = loop.records.emplace_back();
    tick.tick = k;
    tick.lateness_ns = k == 12 ? 300'000 : 50'000;
    tick.tick_cost_ns = static_cast<std::int32_t>(100 * (k + 1));
    tick.window_version = tick.edit_version = version;
    tick.window_age_ns = (k - begin) * 1'000'000 + 400'000;
    if (k == 5 || k == 40) tick.faults = static_cast<std::uint32_t>(ServoFault::kStaleWindow);
  }
  return loop;
}

TEST(ServiceFigures, AreThoseOfTheTicksBetweenFirstAndLastEdit) {
  // Edit 1 was asked for before the first tick; edit 5 is in no window.
  const std::vector<AskedEdit> asked = {
      {1, at_ns(-5)}, {2, at_ns(10.2)}, {3, at_ns(20.5)}, {4, at_ns(30.7)}, {5, at_ns(90.5)}};
  const ServiceFigures figures = serviceFigures(madeUpRun(), kRate_hz, asked);
  EXPECT_EQ(figures.ticks, 80);  // tick 11 begins at 11.05 ms, tick 90 at 90.05 ms
  EXPECT_EQ(figures.skipped_ticks, 7);
  EXPECT_EQ(figures.stale_ticks, 1);
  EXPECT_EQ(figures.windows, 3);
  EXPECT_EQ(figures.edits, 3);
  EXPECT_EQ(figures.unseen_edits, 1);
  // 12.3 - 10.2, 22.05 - 20.5, 33.05 - 30.7 ms.
  EXPECT_DOUBLE_EQ(figures.to_window_ms.p50, 2.1);
  EXPECT_DOUBLE_EQ(figures.to_window_ms.max, 2.35);
  EXPECT_DOUBLE_EQ(figures.first_use_us.p50, 400);
  EXPECT_DOUBLE_EQ(figures.first_use_us.max, 400);
  // The last window, from tick 33 to tick 90.
  EXPECT_EQ(figures.window_age_ms.count, 80U);
  EXPECT_DOUBLE_EQ(figures.window_age_ms.max, 57.4);
  // Of 80 values, rising by 0.1 from that of tick 11: the 40th and the 80th.
  EXPECT_DOUBLE_EQ(figures.tick_cost_us.p50, 5.1);
  EXPECT_DOUBLE_EQ(figures.tick_cost_us.p99, 9.1);
  EXPECT_DOUBLE_EQ(figures.lateness_us.p50, 50);
  EXPECT_DOUBLE_EQ(figures.lateness_us.max, 300);
}

// Each is seen at the first tick whose window holds it or a later one.
TEST(ServiceFigures, AWindowMayHoldSeveralEdits) {
  LoopResult loop = madeUpRun();
  for (TickRecord& tick : loop.records) tick.edit_version = tick.tick < 22 ? 1 : 4;
  const ServiceFigures figures = serviceFigures(loop, kRate_hz, {{2, at_ns(10)}, {3, at_ns(15)}, {4, at_ns(20)}});
  EXPECT_EQ(figures.edits, 3);
  EXPECT_DOUBLE_EQ(figures.to_window_ms.max, 12.05);
  EXPECT_DOUBLE_EQ(figures.to_window_ms.p50, 7.05);
}

TEST(ServiceFigures, WithoutAWindowATickHasNoAge) {
  LoopResult loop = madeUpRun();
  for (TickRecord& tick : loop.records) {
    tick.window_version = tick.edit_version = 0;
    tick.faults = static_cast<std::uint32_t>(ServoFault::kNoWindow);
  }
  const ServiceFigures figures = serviceFigures(loop, kRate_hz, {{1, at_ns(10)}, {2, at_ns(20)}});
  EXPECT_EQ(figures.ticks, 10);
  EXPECT_EQ(figures.stale_ticks, 10);
  EXPECT_EQ(figures.windows, 0);
  EXPECT_EQ(figures.window_age_ms.count, 0U);
  EXPECT_EQ(figures.unseen_edits, 2);
}

TEST(ServiceFigures, WithoutAnEditThereAreNone) {
  for (const std::vector<AskedEdit>& asked : {std::vector<AskedEdit>{}, {{1, at_ns(-1)}}}) {
    const ServiceFigures figures = serviceFigures(madeUpRun(), kRate_hz, asked);
    EXPECT_EQ(figures.ticks, 0);
    EXPECT_EQ(figures.edits, 0);
    EXPECT_EQ(figures.unseen_edits, 0);
  }
}

// Pairs of window ages [ms]; all other figures are 1.
std::vector<ServicePair> pairsOf(const std::vector<std::pair<double, double>>& ages_ms) {
  std::vector<ServicePair> pairs;
  for (const auto& [one_ms, two_ms] : ages_ms) {
    ServiceFigures same;
    for (Percentiles* of :
         {&same.window_age_ms, &same.first_use_us, &same.to_window_ms, &same.tick_cost_us, &same.lateness_us})
      of->p50 = of->p99 = 1;
    ServicePair& pair = pairs.emplace_back(ServicePair{same, same});
    pair.one.window_age_ms.p99 = one_ms;
    pair.two.window_age_ms.p99 = two_ms;
  }
  return pairs;
}

ServiceRatio named(const std::vector<ServiceRatio>& ratios, const std::string& figure) {
  for (const ServiceRatio& ratio : ratios) {
    if (ratio.figure == figure) return ratio;
  }
  ADD_FAILURE() << "there is no " << figure;
  return {};
}

TEST(ServiceRatios, AreFormedWithinPairs) {
  const auto ratios = serviceRatios(pairsOf({{10, 12}, {20, 18}, {40, 44}}));
  const ServiceRatio age = named(ratios, "window age p99 [ms]");
  EXPECT_DOUBLE_EQ(age.one.median, 20);
  EXPECT_DOUBLE_EQ(age.two.median, 18);
  EXPECT_DOUBLE_EQ(age.ratio.median, 1.1);  // not 18 / 20
  EXPECT_DOUBLE_EQ(age.ratio.low, 0.9);
  EXPECT_DOUBLE_EQ(age.ratio.high, 1.2);
  EXPECT_DOUBLE_EQ(age.least, 0.9);
  EXPECT_DOUBLE_EQ(age.most, 1.2);
  EXPECT_DOUBLE_EQ(age.again.median, 2);  // 20 / 10 and 40 / 20
  EXPECT_DOUBLE_EQ(named(ratios, "lateness p99 [us]").ratio.median, 1);
}

// Ranks of the sign test's interval for a median, from the binomial distribution: of 30 values the 10th and the 21st
// (P(at most 9 of 30) = 0.0214, at most 10: 0.049), of 6 the extremes (1/64 = 0.0156), of 9 the 2nd and the 8th
// (10/512 = 0.0195), of 5 none (1/32 = 0.031).
TEST(ServiceRatios, SayHowWellTheirMedianIsKnown) {
  for (const auto& [count, low] : {std::pair(30, 10), {9, 2}, {6, 1}, {5, 1}, {1, 1}}) {
    std::vector<std::pair<double, double>> ages_ms;
    for (int n = count; n > 0; --n) ages_ms.emplace_back(1, n);
    const ServiceRatio age = named(serviceRatios(pairsOf(ages_ms)), "window age p99 [ms]");
    EXPECT_EQ(age.from, low) << count;
    EXPECT_EQ(age.to, count + 1 - low) << count;
  }
}

TEST(ServiceRatios, HaveTheBoundsThatArePromised) {
  const auto ratios = serviceRatios(pairsOf({{1, 1}}));
  EXPECT_EQ(named(ratios, "window age p99 [ms]").bound, 1.2);
  EXPECT_EQ(named(ratios, "tick cost median [us]").bound, 1.05);
  EXPECT_EQ(named(ratios, "tick cost p99 [us]").bound, 1.05);
  EXPECT_EQ(named(ratios, "edit to window median [ms]").bound, 1.2);
  EXPECT_TRUE(std::isnan(named(ratios, "lateness p99 [us]").bound));
}

TEST(ServiceRatios, OnePairHasNoOtherRunToCompareWith) {
  const ServiceRatio age = named(serviceRatios(pairsOf({{4, 5}})), "window age p99 [ms]");
  EXPECT_DOUBLE_EQ(age.ratio.median, 1.25);
  EXPECT_TRUE(std::isnan(age.again.median));
}

TEST(ServiceRatios, WhatIsNoNumberIsLeftOut) {
  const ServiceRatio some = named(serviceRatios(pairsOf({{0, 5}, {2, 3}, {0, 0}})), "window age p99 [ms]");
  EXPECT_DOUBLE_EQ(some.ratio.median, 1.5);
  EXPECT_DOUBLE_EQ(some.most, 1.5);
  const ServiceRatio none = named(serviceRatios(pairsOf({{0, 5}})), "window age p99 [ms]");
  EXPECT_TRUE(std::isnan(none.ratio.median));
  EXPECT_TRUE(std::isnan(none.least));
  EXPECT_TRUE(std::isnan(none.from));
  EXPECT_TRUE(std::isnan(named(serviceRatios({}), "window age p99 [ms]").ratio.median));
}

}  // namespace service_figures_test
}  // namespace palpate
