// SPDX-License-Identifier: Apache-2.0
// palpate bench NAME (apps/bench/benches.cpp): measures, and holds the figures against what the program promises.
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/study/shard.hpp"
#include "apps/study/study.hpp"
#include "bench_outputs.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct BenchFlags : BenchArguments {
  BenchOutputFlags outputs;
};

std::string studyNames() {
  std::vector<std::string> names;
  for (const Study& study : studies()) names.emplace_back(study.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void addFlags(CLI::App& verb, const Bench& bench, BenchFlags& flags) {
  verb.add_flag("--quick", flags.quick, "fewer repetitions, for a first look");
  addOutputFlags(verb, flags.outputs, bench.report != nullptr);
  verb.add_option("--seed", flags.seed, "of everything that is left to chance (default 1)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9007199254740992}));
  const auto takes = [&](std::string_view flag) { return std::ranges::find(bench.takes, flag) != bench.takes.end(); };
  if (takes("seconds")) {
    verb.add_option("--seconds", flags.seconds, bench.seconds)->check(numberFrom(0.1, 3600));
  }
  if (takes("gpu")) {
    verb.add_option("--gpu", flags.gpu, "part of the Vulkan device's name; the best one if not given");
  }
  if (takes("sizes")) {
    verb.add_option("--sizes", flags.sizes,
                    fmt::format("along every edge, with commas [voxel] (default {}; quick {})",
                                fmt::join(bench.sizes, ","), fmt::join(bench.quick_sizes, ",")))
        ->delimiter(',')
        ->check(CLI::Range(16, 640));
  }
  if (takes("studies")) {
    verb.add_option("--study", flags.studies, fmt::format("only these studies, with commas: {}", studyNames()))
        ->type_name("NAME")
        ->delimiter(',');
  }
  if (takes("shard")) {
    verb.add_option("--shard", flags.shard, "only the I-th of N parts; 'palpate bench merge' joins the results")
        ->type_name("I/N");
  }
}

void runVerb(const Bench& bench, const BenchFlags& flags) {
  BenchOutputs outputs(flags.outputs);
  outputs.finish(bench, runBench(bench, flags));
}

void addBench(CLI::App& to, const Bench& bench, const std::shared_ptr<BenchFlags>& flags) {
  CLI::App* verb = to.add_subcommand(bench.name, bench.help);
  addFlags(*verb, bench, *flags);
  verb->callback([&bench, flags] { runVerb(bench, *flags); });
}

}  // namespace

void addBenchVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("bench", "measure, and hold the figures against what the program promises");
  verb->require_subcommand(1);
  auto flags = std::make_shared<BenchFlags>();
  for (const Bench& bench : everyBench()) addBench(*verb, bench, flags);
  addBenchMerge(*verb);
  addBenchShow(*verb);
  addBenchAll(*verb);
}

// The bench of this name is a verb, too: it answers a question of its own.
void addStabilityVerb(CLI::App& app) {
  addBench(app, benchNamed("stability", "stability"), std::make_shared<BenchFlags>());
}

}  // namespace palpate
