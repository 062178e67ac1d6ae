// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_page.hpp"

#include <fmt/format.h>

namespace palpate {

std::string benchPage(const BenchResult& result, const PageWords& words) {
  std::string page = fmt::format("# {}\n\n{}\n\n", words.title, words.introduction);
  page += fmt::format("- machine: {}\n- Vulkan device: {}\n- commit: {}\n- command: `{}`\n\n", result.machine,
                      result.vulkan_device, result.commit, result.command);
  if (!words.chart.empty()) page += fmt::format("![{}]({})\n\n", words.title, words.chart);
  page += "## What is promised\n\n| target | value | at most | |\n|---|---|---|---|\n";
  for (const BenchTarget& target : result.targets) {
    page += fmt::format("| {} | {:.4g} | {:.4g} | {} |\n", target.name, target.value, target.bound,
                        target.holds() ? "holds" : "**does not hold**");
  }
  page += "\n";
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") == "note") page += fmt::format("Note: {}\n\n", textOf(row, "note"));
  }
  return page + "## Figures\n\n```\n" + words.tables + "```\n";
}

}  // namespace palpate
