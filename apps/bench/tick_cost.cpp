// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/tick_cost.hpp"

#include <algorithm>
#include <limits>

#include "apps/sampled/window_follower.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

class DoesNothing final : public Algorithm {
 public:
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W;
  }
};

}  // namespace

// The index of each tick's window.
std::vector<std::size_t> ReplayPath::gather(const BenchVolume& volume, bool at_surface) {
  WindowRule rule;
  std::vector<std::size_t> window_of_tick;
  for (std::size_t k = 0; k < path_.ticks(); ++k) {
    const bool below = at_surface && path_.depth_m[k] > 0;
    const Vec3 place_W = path_.hip_W[k] + (below ? path_.depth_m[k] : 0.0) * path_.normal_W[k];
    if (const auto box = rule.follow(volume, place_W)) {
      SampleWindow window;
      window.version = windows_.size();  // gather() increments it, so all versions differ
      volume.gather(*box, samples_.emplace_back(), window);
      windows_.push_back(window);
    }
    window_of_tick.push_back(windows_.size() - 1);
  }
  return window_of_tick;
}

ReplayPath::ReplayPath(const BenchVolume& volume, ContactPath path) : path_(std::move(path)) {
  const std::vector<std::size_t> tool = gather(volume, false);
  const std::vector<std::size_t> surface = gather(volume, true);
  for (std::size_t k = 0; k < path_.ticks(); ++k) {
    ticks_.push_back({path_.hip_W[k], path_.velocity_W[k], &windows_[tool[k]], &windows_[surface[k]]});
  }
}

TickOutput ReplayPath::approach(Algorithm& algorithm) const {
  algorithm.reset(ticks_.front().hip_W);
  TickOutput out;
  for (std::size_t k = 0; k < path_.slide_begin; ++k) {
    const Tick& tick = ticks_[k];
    algorithm.tick({tick.hip_W, tick.velocity_W, out.at_surface ? tick.at_surface : tick.at_tool}, out);
  }
  return out;
}

double ReplayPath::replay_ns(Algorithm& algorithm) const {
  TickOutput out = approach(algorithm);
  TickInput in;
  const std::int64_t start_ns = monotonicNow_ns();
  for (std::size_t k = path_.slide_begin; k < ticks_.size(); ++k) {
    const Tick& tick = ticks_[k];
    in.hip_W = tick.hip_W + 0.0 * out.force_W;  // waits for the last tick's force
    in.hip_velocity_W = tick.velocity_W;
    in.window = out.at_surface ? tick.at_surface : tick.at_tool;
    algorithm.tick(in, out);
  }
  return static_cast<double>(monotonicNow_ns() - start_ns) / static_cast<double>(slideTicks());
}

void ReplayPath::replayTicks(Algorithm& algorithm, double clock_ns, std::vector<double>& fastest,
                             std::vector<double>& raw) const {
  TickOutput out = approach(algorithm);
  TickInput in;
  std::int64_t before_ns = monotonicNow_ns();
  for (std::size_t k = path_.slide_begin; k < ticks_.size(); ++k) {
    const Tick& tick = ticks_[k];
    in.hip_W = tick.hip_W + 0.0 * out.force_W;
    in.hip_velocity_W = tick.velocity_W;
    in.window = out.at_surface ? tick.at_surface : tick.at_tool;
    algorithm.tick(in, out);
    const std::int64_t after_ns = monotonicNow_ns();
    const double cost_ns = std::max(0.0, static_cast<double>(after_ns - before_ns) - clock_ns);
    double& least_ns = fastest[k - path_.slide_begin];
    least_ns = std::min(least_ns, cost_ns);
    raw.push_back(cost_ns);
    before_ns = after_ns;
  }
}

const Columns<TickCost>& costColumns() {
  using C = TickCost;
  using P = Percentiles;
  static const Columns<C> kColumns =
      joined(Columns<C>{{"cost_ns", [](const C& cost) { return spreadOf(cost.batch_ns).median; }, {"mean", "ns", 1}},
                        {"cost_quartile_1_ns", [](const C& cost) { return spreadOf(cost.batch_ns).low; }},
                        {"cost_quartile_3_ns", [](const C& cost) { return spreadOf(cost.batch_ns).high; }}},
             percentileColumns<C>("tick", "ns", &C::fastest_ns,
                                  {{"median", &P::p50},
                                   {"p99", &P::p99, {"p99", "ns", 0}},
                                   {"p999", &P::p999, {"p99.9", "ns", 0}},
                                   {"max", &P::max, {"max", "ns", 0}}}),
             percentileColumns<C>("tick_raw", "ns", &C::raw_ns,
                                  {{"median", &P::p50}, {"p99", &P::p99}, {"p999", &P::p999}, {"max", &P::max}}));
  return kColumns;
}

std::vector<TickCost> tickCosts(const ReplayPath& path, std::span<Entrant> entrants, const CostRequest& request,
                                const BenchProgress& progress) {
  const std::size_t count = entrants.size();
  std::vector<TickCost> costs(count);
  const int rounds = request.repetitions + request.tick_replays;
  const auto atRound = [&](int round, auto work) {
    progress(static_cast<double>(round) / rounds);
    for (std::size_t i = 0; i < count; ++i) work((i + static_cast<std::size_t>(round)) % count);
  };
  for (Entrant& entrant : entrants) static_cast<void>(path.replay_ns(*entrant.haptic));  // warms caches and predictors
  for (int round = 0; round < request.repetitions; ++round) {
    atRound(round, [&](std::size_t e) { costs[e].batch_ns.push_back(path.replay_ns(*entrants[e].haptic)); });
  }
  const double clock_ns = clockCost_ns();
  std::vector<std::vector<double>> fastest(
      count, std::vector<double>(path.slideTicks(), std::numeric_limits<double>::infinity()));
  std::vector<std::vector<double>> raw(count);
  for (std::vector<double>& r : raw) r.reserve(path.slideTicks() * static_cast<std::size_t>(request.tick_replays));
  for (int round = 0; round < request.tick_replays; ++round) {
    atRound(request.repetitions + round,
            [&](std::size_t e) { path.replayTicks(*entrants[e].haptic, clock_ns, fastest[e], raw[e]); });
  }
  for (std::size_t e = 0; e < count; ++e) {
    costs[e].fastest_ns = percentiles(std::move(fastest[e]));
    costs[e].raw_ns = percentiles(std::move(raw[e]));
  }
  return costs;
}

double clockCost_ns() {
  constexpr int kReadings = 20001;
  std::vector<double> costs;
  costs.reserve(kReadings);
  std::int64_t before_ns = monotonicNow_ns();
  for (int i = 0; i < kReadings; ++i) {
    const std::int64_t after_ns = monotonicNow_ns();
    costs.push_back(static_cast<double>(after_ns - before_ns));
    before_ns = after_ns;
  }
  return percentiles(std::move(costs)).p50;
}

double harnessCost_ns(const ReplayPath& path) {
  constexpr int kRepetitions = 15;
  DoesNothing nothing;
  std::vector<double> costs;
  for (int i = 0; i < kRepetitions; ++i) costs.push_back(path.replay_ns(nothing));
  return spreadOf(std::move(costs)).median;
}

Spread spreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75)};
}

}  // namespace palpate
