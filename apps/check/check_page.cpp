// SPDX-License-Identifier: Apache-2.0
#include "apps/check/check_page.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace palpate {
namespace {

// "gaussian" for "gaussian:1.5"; for several filters, that they are a chain.
std::string kindOf(const Check& check) {
  if (check.name != "filter") return check.what;
  if (check.what.find(' ') != std::string::npos) return "chain of " + check.what;
  return check.what.substr(0, check.what.find(':'));
}

std::string withoutFolder(const std::string& volume) {
  return volume.starts_with("phantom:") ? volume : volume.substr(volume.rfind('/') + 1);
}

struct Row {
  std::string name, kind, promise;
  std::set<std::string> volumes;
  std::uint64_t compared = 0, differing = 0, broken = 0;
  double largest_share = 0;
  bool bounded = false, holds = true;
};

// Rows in the order in which each kind first occurs.
std::vector<Row> rowsOf(std::span<const Check> checks) {
  std::vector<Row> rows;
  for (const Check& check : checks) {
    const std::string kind = kindOf(check), promise = promiseWords(check);
    auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
      return row.name == check.name && row.kind == kind && row.promise == promise;
    });
    if (found == rows.end()) {
      rows.push_back({});
      found = std::prev(rows.end());
      found->name = check.name;
      found->kind = kind;
      found->promise = promise;
      found->bounded = !check.reason.empty();
    }
    found->volumes.insert(check.volume);
    found->compared += check.compared;
    found->differing += check.differing;
    found->broken += check.broken;
    found->largest_share = std::max(found->largest_share, check.largest_share);
    found->holds = found->holds && check.holds();
  }
  return rows;
}

}  // namespace

std::string checkPage(std::span<const Check> checks, const CheckRun& run) {
  std::string text = fmt::format(
      R"(# What the GPU computes, against the CPU twins

Every value of every pass, compared with a twin that was written apart; docs/filters.md and docs/gradients.md say
what is promised and why. Steps of a filter are checks of their own, for what the GPU made of the step before.

- machine: {}
- Vulkan device: {}
- commit: {}
- command: `{}`

)",
      run.machine, checks.empty() ? "none" : checks[0].device, run.commit, run.command);
  const auto held = std::count_if(checks.begin(), checks.end(), [](const Check& check) { return check.holds(); });
  text += fmt::format("**{} of {} checks hold.**\n\n", held, checks.size());
  text +=
      "| holds | check | of | volumes | values | differing bits | broken | largest share of its bound | promise |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rowsOf(checks)) {
    text += fmt::format("| {} | {} | `{}` | {} | {} | {} | {} | {} | {} |\n", row.holds ? "yes" : "**no**", row.name,
                        row.kind, row.volumes.size(), row.compared, row.differing, row.broken,
                        row.bounded ? fmt::format("{:.2g}", row.largest_share) : "", row.promise);
  }
  text += "\nVolumes:\n\n";
  std::string last;
  for (const Check& check : checks) {
    if (check.volume == last) continue;
    last = check.volume;
    text += fmt::format("- `{}`\n", withoutFolder(check.volume));
  }
  std::set<std::string> reasons;
  for (const Check& check : checks) {
    if (!check.reason.empty() && reasons.insert(check.reason).second) text += fmt::format("\n{}\n", check.reason);
  }
  for (const std::string& what : run.left_out) text += fmt::format("\nLeft out: {}\n", withoutFolder(what));
  return text;
}

}  // namespace palpate
