// SPDX-License-Identifier: Apache-2.0
#include "apps/study/cell_runner.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <variant>

#include "apps/bench/turns.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

// NaN is equal to NaN: "there is no such figure".
bool isSame(const BenchFigure& a, const BenchFigure& b) {
  const auto* x = std::get_if<double>(&a);
  const auto* y = std::get_if<double>(&b);
  return a == b || (x != nullptr && y != nullptr && std::isnan(*x) && std::isnan(*y));
}

bool isSame(const BenchRow& a, const BenchRow& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && isSame(one.second, other.second);
  });
}

// How long the rest will take, from how long each cell took last.
class TimeLeft {
 public:
  TimeLeft(std::size_t cells, int rounds) : seconds_(cells, -1), rounds_(rounds) {}
  void took(std::size_t cell, double seconds) { seconds_[cell] = seconds; }

  [[nodiscard]] RunState after(int round, const std::vector<std::size_t>& order, std::size_t done) const {
    double known = 0, sum = 0;
    for (const double seconds : seconds_) {
      known += seconds >= 0 ? 1 : 0;
      sum += std::max(seconds, 0.0);
    }
    const double usual = known > 0 ? sum / known : 0;
    const auto of = [&](std::size_t cell) { return seconds_[cell] >= 0 ? seconds_[cell] : usual; };
    double all = 0, rest = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      all += of(order[i]);
      rest += i >= done ? of(order[i]) : 0;
    }
    const double left_s = rest + all * (rounds_ - 1 - round);
    return {round, all > 0 ? 1 - left_s / (all * rounds_) : 0, left_s};
  }

 private:
  std::vector<double> seconds_;  // below 0: it did not run yet
  int rounds_;
};

// Adds what a run found. The warm-up's times are there until those of the first round replace them.
void add(CellRun& run, CellFigures&& found, int round) {
  if (round == 0) {
    run.errors = std::move(found.errors);
    for (auto& [key, cost] : found.costs) run.costs.emplace_back(key, std::vector<double>{cost});
    return;
  }
  run.repeats = run.repeats && isSame(run.errors, found.errors);
  for (std::size_t i = 0; i < found.costs.size(); ++i) {
    std::vector<double>& each = run.costs.at(i).second;
    if (round == 1) each.clear();
    each.push_back(found.costs[i].second);
  }
}

}  // namespace

std::vector<std::size_t> orderOfRound(std::size_t count, std::uint64_t seed, int round) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::seed_seq both{seed, seed >> 32U, static_cast<std::uint64_t>(round)};
  std::mt19937_64 bits(both);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[bits() % i]);  // Fisher and Yates
  return order;
}

CellRuns runCells(std::span<const StudyCell* const> cells, const RunPlan& plan, const std::function<bool()>& stop,
                  const std::function<void(const RunState&)>& tell) {
  CellRuns runs{std::vector<CellRun>(cells.size()), false};
  TimeLeft left(cells.size(), plan.rounds + 1);
  for (int round = 0; round <= plan.rounds; ++round) {
    const std::vector<std::size_t> order = orderOfRound(cells.size(), plan.seed, round);
    for (std::size_t n = 0; n < order.size(); ++n) {
      tell(left.after(round, order, n));
      CellRun& run = runs.cells[order[n]];
      if (!run.left_out.empty()) continue;
      const Stopwatch watch;
      try {
        runs.stopped = stop();
        if (runs.stopped) return runs;
        const std::string failure = failureOf([&] { add(run, cells[order[n]]->run(), round); });
        if (!failure.empty()) run = CellRun{.errors = {}, .costs = {}, .repeats = true, .left_out = failure};
      } catch (const Error&) {  // failureOf() lets only kCancelled through
        runs.stopped = true;
        return runs;
      }
      left.took(order[n], watch.seconds());
    }
  }
  return runs;
}

}  // namespace palpate
