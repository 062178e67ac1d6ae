// SPDX-License-Identifier: Apache-2.0
#include "tune_figures.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/bench/bench_result.hpp"
#include "base/atomic_file.hpp"

namespace palpate {
namespace {

constexpr const char* kIntroduction = R"(
`palpate tune` on random scenes; the seed gives the scene and what is asked of it.
`told` is what `palpate tune` says: of its fresh runs, or of the nearest where nothing keeps the goal.
`fresh` is one more run of the written scene, by `palpate touch --clock simulated`.
It knows no error where the exact surface is not known; there `told` alone is judged.
A `cannot` is held against every trial of its JSON, and against the scene as it is: none may keep the goal with its margin.
An error by the simulated clock is the same in every run, so not one may miss.
A time depends on what else the machine does: the budget's misses are counted, and told.)";

std::string tableOf(const std::vector<TunedScene>& scenes) {
  std::string text = fmt::format("{:>4} {:>8} {:>9} {:<7}{:>9}{:>9}{:>7}  {:<46} {}\n", "seed", "goal", "asked", "",
                                 "told", "fresh", "s", "chosen, or nearest", "scene");
  for (const TunedScene& s : scenes) {
    const std::string fresh = s.fresh < 0 ? "-" : fmt::format("{:.3g}", s.fresh);
    const std::string mark = s.met ? (s.within ? "" : " MISSED") : (s.denied ? " DENIED" : "");
    text += fmt::format("{:>4} {:>8} {:>9} {:<7}{:>9.3g}{:>9}{:>7.1f}  {:<46} {}{}\n", s.seed,
                        s.error ? "--error" : "--budget", fmt::format("{:g}{}", s.bound, s.error ? "N" : "us"),
                        s.met ? "met" : "cannot", s.figure, fresh, s.seconds, s.choice, s.scene, mark);
  }
  return text;
}

}  // namespace

void writeTuneFigures(const std::vector<TunedScene>& scenes, const std::string& command, const std::string& commit,
                      const std::string& vulkan_device, const std::filesystem::path& folder) {
  BenchResult result{.bench = "tune",
                     .commit = commit,
                     .machine = machineInWords(),
                     .vulkan_device = vulkan_device,
                     .command = command,
                     .rows = {},
                     .targets = {}};
  const auto count = [&](const auto& which) { return static_cast<double>(std::ranges::count_if(scenes, which)); };
  result.targets.push_back({"errors that a fresh run does not keep",
                            count([](const TunedScene& s) { return s.met && s.error && !s.within; }), 0});
  result.targets.push_back({"cannots that a trial or the scene itself denies",
                            count([](const TunedScene& s) { return !s.met && s.denied; }), 0});
  const double budgets = count([](const TunedScene& s) { return s.met && !s.error; });
  const double missed = count([](const TunedScene& s) { return s.met && !s.error && !s.within; });
  const std::string tables =
      fmt::format("{}\n{} scenes, {} met; of {} budgets that are met one fresh run misses {}\n", tableOf(scenes),
                  scenes.size(), count([](const TunedScene& s) { return s.met; }), budgets, missed);
  writeFileAtomically(folder / "tune.md", benchPage(result, {.title = "What a tuned scene keeps",
                                                             .introduction = asParagraph(kIntroduction),
                                                             .tables = tables,
                                                             .chart = {}}));
}

}  // namespace palpate
