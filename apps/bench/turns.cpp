// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/turns.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kNeedsNoWarmUp_ms = 1000;

// Runs once. Empty if the run failed; `outcome` then has the reason.
std::optional<RunCost> runOnce(const Contender& entrant, TurnsOutcome& outcome) {
  RunCost cost;
  outcome.left_out = failureOf([&] { cost = entrant.run(); });
  return outcome.left_out.empty() ? std::optional(cost) : std::nullopt;
}

}  // namespace

std::string failureOf(const std::function<void()>& work) {
  try {
    work();
    return "";
  } catch (const Error& failure) {
    if (failure.code() == Error::Code::kCancelled) throw;
    return failure.what();
  } catch (const std::bad_alloc&) {
    return "there was not enough memory";
  } catch (const std::exception& failure) {  // of a library's own kind
    return failure.what();
  }
}

std::vector<TurnsOutcome> Turns::take(const std::string& job, double voxels, const std::vector<Contender>& entrants) {
  std::vector<TurnsOutcome> outcomes;
  std::vector<int> rounds;
  for (const Contender& entrant : entrants) {
    throwIfInterrupted("palpate bench");
    TurnsOutcome& outcome = outcomes.emplace_back(TurnsOutcome{entrant.library, entrant.way, {}, {}, {}});
    double& known = cpu_ms_per_voxel_[fmt::format("{}|{}|{}", job, entrant.library, entrant.way)];
    rounds.push_back(0);
    if (!entrant.own && known * voxels > 1e3 * plan_.longest_s) {
      outcome.left_out = fmt::format("one run would take some {:.0f} s of processor time", 1e-3 * known * voxels);
      continue;
    }
    const std::optional<RunCost> cost = runOnce(entrant, outcome);
    if (!cost) continue;
    known = cost->cpu_ms / voxels;
    rounds.back() =
        std::clamp(static_cast<int>(1e3 * plan_.budget_s / std::max(cost->wall_ms, 1e-3)), 1, plan_.most_rounds);
    if (!entrant.own && cost->wall_ms > kNeedsNoWarmUp_ms) outcome.add(*cost);
  }
  const int most = rounds.empty() ? 0 : *std::max_element(rounds.begin(), rounds.end());
  for (int round = 0; round < most; ++round) {
    for (std::size_t n = 0; n < entrants.size(); ++n) {
      throwIfInterrupted("palpate bench");
      const std::size_t who = (n + static_cast<std::size_t>(round)) % entrants.size();
      TurnsOutcome& outcome = outcomes[who];
      if (!outcome.left_out.empty() || static_cast<int>(outcome.wall_ms.size()) >= rounds[who]) continue;
      if (const std::optional<RunCost> cost = runOnce(entrants[who], outcome)) outcome.add(*cost);
    }
  }
  return outcomes;
}

}  // namespace palpate
