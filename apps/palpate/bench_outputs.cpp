// SPDX-License-Identifier: Apache-2.0
#include "bench_outputs.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/plan/plan_bench.hpp"
#include "apps/scene/scene_command.hpp"
#include "apps/stability/stability_bench.hpp"
#include "apps/study/error_bench.hpp"
#include "apps/study/mask_bench.hpp"
#include "apps/study/shard.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "scene_arguments.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr int kTargetBroken = 1;

std::string commandLine(const Bench& bench, const BenchArguments& arguments) {
  std::string line = fmt::format("palpate bench {}", bench.name);
  if (arguments.quick) line += " --quick";
  if (arguments.seconds) line += fmt::format(" --seconds {:g}", *arguments.seconds);
  if (!arguments.sizes.empty()) line += fmt::format(" --sizes {}", fmt::join(arguments.sizes, ","));
  if (!arguments.studies.empty()) line += fmt::format(" --study {}", fmt::join(arguments.studies, ","));
  if (!arguments.gpu.empty()) line += " --gpu " + shellWord(arguments.gpu);
  line += fmt::format(" --seed {}", arguments.seed);
  return arguments.shard.empty() ? line : line + shardWords(shardOf(arguments.shard));
}

// The path of a file relative to the page's folder.
std::string fromPage(const std::string& file, const std::string& page) {
  if (file.empty()) return {};
  const auto folder = std::filesystem::absolute(page).parent_path();
  return std::filesystem::absolute(file).lexically_relative(folder).generic_string();
}

}  // namespace

const std::vector<Bench>& everyBench() {
  static const std::vector<Bench> kAll = [] {
    std::vector<Bench> all = benches();
    all.push_back(errorBench());
    all.push_back(maskBench());
    all.push_back(stabilityBench());
    all.push_back(planBench());
    return all;
  }();
  return kAll;
}

const Bench& benchNamed(const std::string& name, const std::string& input) {
  std::vector<std::string> names;
  for (const Bench& bench : everyBench()) {
    if (bench.name == name) return bench;
    names.emplace_back(bench.name);
  }
  refuse(input, fmt::format("there is no bench '{}'", name),
         withDidYouMean(name, names, fmt::format("the benches are {}", fmt::join(names, ", "))));
}

void addOutputFlags(CLI::App& verb, BenchOutputFlags& flags, bool report) {
  verb.add_flag("--strict", flags.strict, "exit status 1 when a target does not hold");
  verb.add_option("--json", flags.json, "write rows and targets into this file too")->type_name("FILE");
  verb.add_option("--csv", flags.csv, "write the rows into this file too")->type_name("FILE");
  CLI::Option* chart =
      verb.add_option("--chart", flags.chart, "draw the figures into this SVG file")->type_name("FILE.svg");
  verb.add_option("--panel", flags.panels,
                  "of the chart, draw only the panels of these titles (may be given several times)")
      ->type_name("TITLE")
      ->needs(chart)
      ->allow_extra_args(false);
  verb.add_option("--page", flags.page, "write a page to read into this Markdown file")->type_name("FILE.md");
  if (!report) return;
  verb.add_option("--report", flags.report, "write a report with all plots and figures into this HTML file")
      ->type_name("FILE.html");
}

BenchOutputs::BenchOutputs(const BenchOutputFlags& flags) : flags_(flags) {
  checkOutputsDiffer({flags.json, flags.csv, flags.chart, flags.page, flags.report});
  add(flags.json, [](const Bench&, const BenchResult& result, const std::string&) { return jsonText(result); });
  add(flags.csv, [](const Bench&, const BenchResult& result, const std::string&) { return csvText(result); });
  add(flags.report,
      [](const Bench& bench, const BenchResult& result, const std::string&) { return bench.report(result); });
  add(flags.page, [this](const Bench& bench, const BenchResult& result, const std::string& tables) {
    return benchPage(result, {bench.title, bench.introduction, tables, fromPage(flags_.chart, flags_.page)});
  });
  // The last one: only now is it known which titles there are, and what was measured is not lost for a wrong one.
  add(flags.chart, [this](const Bench& bench, const BenchResult& result, const std::string&) {
    LogCharts charts = bench.charts(result);
    return logChartSvg(flags_.panels.empty() ? charts : onlyPanels(std::move(charts), flags_.panels));
  });
}

void BenchOutputs::add(const std::string& name, Text text) {
  if (!name.empty()) files_.emplace_back(name, std::move(text));
}

void BenchOutputs::finish(const Bench& bench, const BenchResult& result) {
  const std::string tables = bench.table(result);
  for (auto& [file, text] : files_) {
    file.write(text(bench, result, tables));
    file.commit();
  }
  printResult("{}\n{}\n{}, commit {}\n{}", tables, result.command, result.machine, result.commit, targetTable(result));
  if (result.stopped) {
    throw Error(Error::Code::kCancelled, fmt::format("palpate bench {}", bench.name), "stopped by the user",
                "what was measured until then is in the result, which says so");
  }
  if (flags_.strict && !result.allHold()) throw CLI::RuntimeError(kTargetBroken);
}

BenchResult runBench(const Bench& bench, const BenchArguments& arguments) {
  Progress progress;
  BenchArguments known = arguments;
  known.commit = programCommit();
  BenchResult result = bench.run(bench, known, progress);
  progress.done();
  result.commit = programCommit();
  result.command = commandLine(bench, arguments);
  return result;
}

}  // namespace palpate
