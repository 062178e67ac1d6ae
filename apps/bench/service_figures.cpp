// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/service_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/units.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A figure of a run, and what its ratio may be.
struct ComparedFigure {
  const char* name;
  Percentiles ServiceFigures::*of;
  double Percentiles::*which;
  double bound;
};
constexpr ComparedFigure kCompared[] = {
    {"window age p99 [ms]", &ServiceFigures::window_age_ms, &Percentiles::p99, 1.2},
    {"tick cost median [us]", &ServiceFigures::tick_cost_us, &Percentiles::p50, 1.05},
    {"tick cost p99 [us]", &ServiceFigures::tick_cost_us, &Percentiles::p99, 1.05},
    {"edit to window median [ms]", &ServiceFigures::to_window_ms, &Percentiles::p50, 1.2},
    {"edit to window p99 [ms]", &ServiceFigures::to_window_ms, &Percentiles::p99, kUnknown},
    {"window age median [ms]", &ServiceFigures::window_age_ms, &Percentiles::p50, kUnknown},
    {"window age at first use median [us]", &ServiceFigures::first_use_us, &Percentiles::p50, kUnknown},
    {"window age at first use p99 [us]", &ServiceFigures::first_use_us, &Percentiles::p99, kUnknown},
    {"lateness median [us]", &ServiceFigures::lateness_us, &Percentiles::p50, kUnknown},
    {"lateness p99 [us]", &ServiceFigures::lateness_us, &Percentiles::p99, kUnknown},
};

void addFinite(std::vector<double>& ratios, double value, double of) {
  const double ratio = value / of;
  if (std::isfinite(ratio)) ratios.push_back(ratio);
}

Spread spreadOrUnknown(const std::vector<double>& values) {
  return values.empty() ? Spread{kUnknown, kUnknown, kUnknown} : spreadOf(values);
}

// Of a sorted list: the element that lies below the true median but in one of forty such lists, by the signs of the
// differences from it, which are tosses of a coin; the first where the list is too short for that.
std::size_t lowBesideMedian(std::size_t count) {
  double chance = std::exp2(-static_cast<double>(count)), below = 0;  // of k tails; of at most k
  std::size_t low = 0;
  for (std::size_t k = 0; k < count; ++k) {
    below += chance;
    if (below > 0.025) break;
    low = k;
    chance *= static_cast<double>(count - k) / static_cast<double>(k + 1);
  }
  return low;
}

ServiceRatio ratioOf(const ComparedFigure& compared, const std::vector<ServicePair>& pairs) {
  const auto value = [&](const ServiceFigures& run) { return run.*compared.of.*compared.which; };
  std::vector<double> one, two, ratio, again;
  for (const ServicePair& pair : pairs) {
    if (!one.empty()) addFinite(again, value(pair.one), one.back());
    one.push_back(value(pair.one));
    two.push_back(value(pair.two));
    addFinite(ratio, two.back(), one.back());
  }
  std::ranges::sort(ratio);
  const std::size_t low = lowBesideMedian(ratio.size());
  return {.figure = compared.name,
          .bound = compared.bound,
          .one = spreadOrUnknown(one),
          .two = spreadOrUnknown(two),
          .ratio = spreadOrUnknown(ratio),
          .least = ratio.empty() ? kUnknown : ratio.front(),
          .most = ratio.empty() ? kUnknown : ratio.back(),
          .from = ratio.empty() ? kUnknown : ratio[low],
          .to = ratio.empty() ? kUnknown : ratio[ratio.size() - 1 - low],
          .again = spreadOrUnknown(again)};
}

}  // namespace

ServiceFigures serviceFigures(const LoopResult& loop, double rate_hz, const std::vector<AskedEdit>& asked) {
  ServiceFigures figures;
  figures.skipped_ticks = loop.ticks_skipped;
  auto edit = std::ranges::find_if(asked, [&](const AskedEdit& one) { return one.at_ns >= loop.first_due_ns; });
  if (edit == asked.end()) return figures;
  const std::int64_t first_ns = edit->at_ns, last_ns = asked.back().at_ns;
  std::vector<double> age_ms, first_use_us, to_window_ms, cost_us, lateness_us;
  std::uint64_t version = 0;
  for (const TickRecord& tick : loop.records) {
    const std::int64_t begin_ns = loop.first_due_ns + tick.lateness_ns +
                                  std::llround(static_cast<double>(tick.tick) * kNanosecondsPerSecond / rate_hz);
    for (; edit != asked.end() && edit->version <= tick.edit_version; ++edit)
      to_window_ms.push_back(static_cast<double>(begin_ns - edit->at_ns) * 1e-6);
    const bool is_first_use = std::exchange(version, tick.window_version) != tick.window_version;
    if (begin_ns < first_ns || begin_ns > last_ns) continue;
    ++figures.ticks;
    figures.stale_ticks += has(tick.faults, ServoFault::kStaleWindow) || has(tick.faults, ServoFault::kNoWindow);
    cost_us.push_back(tick.tick_cost_ns * 1e-3);
    lateness_us.push_back(static_cast<double>(tick.lateness_ns) * 1e-3);
    if (tick.window_version == 0) continue;
    age_ms.push_back(static_cast<double>(tick.window_age_ns) * 1e-6);
    if (is_first_use) first_use_us.push_back(static_cast<double>(tick.window_age_ns) * 1e-3);
  }
  figures.windows = static_cast<std::int64_t>(first_use_us.size());
  figures.edits = static_cast<std::int64_t>(to_window_ms.size());
  figures.unseen_edits = asked.end() - edit;
  figures.window_age_ms = percentiles(std::move(age_ms));
  figures.first_use_us = percentiles(std::move(first_use_us));
  figures.to_window_ms = percentiles(std::move(to_window_ms));
  figures.tick_cost_us = percentiles(std::move(cost_us));
  figures.lateness_us = percentiles(std::move(lateness_us));
  return figures;
}

std::vector<ServiceRatio> serviceRatios(const std::vector<ServicePair>& pairs) {
  std::vector<ServiceRatio> ratios;
  for (const ComparedFigure& compared : kCompared) ratios.push_back(ratioOf(compared, pairs));
  return ratios;
}

}  // namespace palpate
