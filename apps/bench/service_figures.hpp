// SPDX-License-Identifier: Apache-2.0
// apps/bench/service_figures.hpp: what a run says of the way from the engine to the servo, and how runs in two
// processes compare with runs in one.
//
// All times are on the run's clock, which both processes share (CLOCK_MONOTONIC) [ns]. Any thread. Cost: some sorts of
// the run's ticks. No errors: what cannot be computed is NaN.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/tick_cost.hpp"
#include "base/quantile.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

// An edit that was asked for while the servo ran.
struct AskedEdit {
  std::uint64_t version = 0;  // of the volume, once the edit is made (Engine::editVersion)
  std::int64_t at_ns = 0;     // when it was asked for
};

// Of the ticks between the first and the last edit that were asked for during the run: before and after, windows get as
// old as the way lets them, and how long that lasts depends on how long the servo takes to start. Skipped ticks and
// edits are those of the whole run.
struct ServiceFigures {
  std::int64_t ticks = 0;
  std::int64_t skipped_ticks = 0;  // grid points left out
  std::int64_t stale_ticks = 0;    // without a window, or with one that the engine had not confirmed for too long
  std::int64_t windows = 0;        // that ticks began to use
  std::int64_t edits = 0;          // that a tick's window held
  std::int64_t unseen_edits = 0;   // that no tick's window held before the run's end
  Percentiles window_age_ms;       // of each tick's window: time since it was published
  Percentiles first_use_us;        // the same at the first tick that used a window
  Percentiles to_window_ms;        // from asking for an edit to the begin of the first tick whose window held it
  Percentiles tick_cost_us, lateness_us;
};

// `asked`: in the order in which they were asked for and made. Those of before the first tick do not count.
[[nodiscard]] ServiceFigures serviceFigures(const LoopResult& loop, double rate_hz,
                                            const std::vector<AskedEdit>& asked);

// Two runs of the same, one after the other.
struct ServicePair {
  ServiceFigures one, two;  // processes
};

// One figure over all pairs.
struct ServiceRatio {
  std::string figure;          // with its unit
  double bound = 0;            // that the median of the ratios must not exceed; NaN: nothing is promised
  Spread one, two;             // the figure itself
  Spread ratio;                // two processes over one, each within its pair
  double least = 0, most = 0;  // of these ratios
  // Between them lies the ratio's true median in 95 of 100 such series; with fewer than six pairs they are the
  // extremes.
  double from = 0, to = 0;
  Spread again;  // one process over one process, of the pair before: what two equal runs differ by; NaN with one pair
};
// In a fixed order. A pair whose ratio is not finite is left out of it.
[[nodiscard]] std::vector<ServiceRatio> serviceRatios(const std::vector<ServicePair>& pairs);

}  // namespace palpate
