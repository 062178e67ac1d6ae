// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/all_benches.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {
namespace {

std::string heldInWords(const BenchResult& result) {
  return fmt::format("{} of {}", std::ranges::count_if(result.targets, &BenchTarget::holds), result.targets.size());
}

std::string targetRow(const std::string& bench, const BenchTarget& target) {
  return fmt::format("| {} | {} | {:.4g} | {:.4g} | {} |\n", bench, target.name, target.value, target.bound,
                     target.holds() ? "holds" : "**does not hold**");
}

std::string targetRows(const std::vector<BenchOutcome>& outcomes, bool broken_only) {
  std::string rows;
  for (const BenchOutcome& outcome : outcomes) {
    if (!outcome.result) continue;
    for (const BenchTarget& target : outcome.result->targets) {
      if (!broken_only || !target.holds()) rows += targetRow(outcome.name, target);
    }
  }
  return rows;
}

constexpr const char* kTargetHead = "| bench | target | value | at most | |\n|---|---|---|---|---|\n";

}  // namespace

std::string outcomeInWords(const BenchOutcome& outcome) {
  if (!outcome.result) return fmt::format("{}: failed: {}", outcome.name, outcome.failure);
  return fmt::format("{}: {} targets hold, {:.0f} s", outcome.name, heldInWords(*outcome.result), outcome.seconds);
}

std::string allBenchesPage(const std::vector<BenchOutcome>& outcomes, const std::string& command) {
  const auto measured = std::ranges::find_if(outcomes, [](const auto& outcome) { return outcome.result.has_value(); });
  std::string page = "# All benches\n\n";
  if (measured != outcomes.end()) {
    page += fmt::format("- machine: {}\n- commit: {}\n", measured->result->machine, measured->result->commit);
  }
  page +=
      fmt::format("- command: `{}`\n\n| bench | what | targets that hold | time [s] |\n|---|---|---|---|\n", command);
  for (const BenchOutcome& outcome : outcomes) {
    const std::string name = outcome.page.empty() ? outcome.name : fmt::format("[{}]({})", outcome.name, outcome.page);
    page +=
        fmt::format("| {} | {} | {} | {:.0f} |\n", name, outcome.title,
                    outcome.result ? heldInWords(*outcome.result) : "**failed**: " + outcome.failure, outcome.seconds);
  }
  const std::string broken = targetRows(outcomes, true);
  page += "\n## Targets that do not hold\n\n" + (broken.empty() ? std::string("None.\n") : kTargetHead + broken);
  return page + "\n## All targets\n\n" + kTargetHead + targetRows(outcomes, false);
}

}  // namespace palpate
