// SPDX-License-Identifier: Apache-2.0
// palpate bench NAME (apps/bench/benches.cpp): measures, and holds the figures against what the program promises.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <list>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/benches.hpp"
#include "apps/console/message.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr int kTargetBroken = 1;

struct BenchFlags : BenchArguments {
  bool strict = false;
  std::string json, csv, chart, page;
};

// Not CLI::Range, which accepts NaN.
std::string checkSeconds(const std::string& text) {
  constexpr double kLeast_s = 0.1, kMost_s = 3600;
  double value = 0;
  const bool number = CLI::detail::lexical_cast(text, value);
  if (number && value >= kLeast_s && value <= kMost_s) return {};
  return fmt::format("'{}' is no number from {:g} to {:g}", text, kLeast_s, kMost_s);
}

void addFlags(CLI::App& verb, const Bench& bench, BenchFlags& flags) {
  verb.add_flag("--quick", flags.quick, "fewer repetitions, for a first look");
  verb.add_flag("--strict", flags.strict, "exit status 1 when a target does not hold");
  verb.add_option("--json", flags.json, "write rows and targets into this file too")->type_name("FILE");
  verb.add_option("--csv", flags.csv, "write the rows into this file too")->type_name("FILE");
  verb.add_option("--chart", flags.chart, "draw the figures into this SVG file")->type_name("FILE.svg");
  verb.add_option("--page", flags.page, "write a page to read into this Markdown file")->type_name("FILE.md");
  verb.add_option("--seed", flags.seed, "of everything that is left to chance (default 1)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9007199254740992}));
  const auto takes = [&](std::string_view flag) { return std::ranges::find(bench.takes, flag) != bench.takes.end(); };
  if (takes("seconds")) {
    verb.add_option("--seconds", flags.seconds, "how long each side runs at each rate [s] (default 30; quick 2)")
        ->check(checkSeconds);
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
}

std::string commandLine(const Bench& bench, const BenchFlags& flags) {
  std::string line = fmt::format("palpate bench {}", bench.name);
  if (flags.quick) line += " --quick";
  if (flags.seconds) line += fmt::format(" --seconds {:g}", *flags.seconds);
  if (!flags.sizes.empty()) line += fmt::format(" --sizes {}", fmt::join(flags.sizes, ","));
  if (!flags.gpu.empty()) line += " --gpu " + shellWord(flags.gpu);
  return line + fmt::format(" --seed {}", flags.seed);
}

// The output files. They are opened before the bench runs, so that a bad name is refused in the first second.
class Outputs {
 public:
  void add(const std::string& name, std::function<std::string()> text) {
    if (name.empty()) return;
    files_.emplace_back(name, std::move(text));
  }
  void write() {
    for (auto& [file, text] : files_) {
      file.write(text());
      file.commit();
    }
  }

 private:
  std::list<std::pair<AtomicFile, std::function<std::string()>>> files_;
};

// The path of the chart relative to the page's folder.
std::string chartFromPage(const BenchFlags& flags) {
  if (flags.chart.empty() || flags.page.empty()) return {};
  const auto folder = std::filesystem::absolute(flags.page).parent_path();
  return std::filesystem::absolute(flags.chart).lexically_relative(folder).generic_string();
}

void runVerb(const Bench& bench, const BenchFlags& flags) {
  BenchResult result;
  std::string tables;
  checkOutputsDiffer({flags.json, flags.csv, flags.chart, flags.page});
  Outputs outputs;
  outputs.add(flags.json, [&] { return jsonText(result); });
  outputs.add(flags.csv, [&] { return csvText(result); });
  outputs.add(flags.chart, [&] { return bench.chart(result); });
  outputs.add(flags.page, [&] {
    return benchPage(result, {bench.title, bench.introduction, tables, chartFromPage(flags)});
  });
  Progress progress;
  result = bench.run(bench, flags, progress);
  progress.done();
  result.commit = programCommit();
  result.command = commandLine(bench, flags);
  tables = bench.table(result);
  outputs.write();
  printResult("{}\n{}\n{}, commit {}\n{}", tables, result.command, result.machine, result.commit, targetTable(result));
  if (flags.strict && !result.allHold()) throw CLI::RuntimeError(kTargetBroken);
}

}  // namespace

void addBenchVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("bench", "measure, and hold the figures against what the program promises");
  verb->require_subcommand(1);
  auto flags = std::make_shared<BenchFlags>();
  for (const Bench& bench : benches()) {
    CLI::App* one = verb->add_subcommand(bench.name, bench.help);
    addFlags(*one, bench, *flags);
    one->callback([&bench, flags] { runVerb(bench, *flags); });
  }
}

}  // namespace palpate
