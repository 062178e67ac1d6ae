// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/start_bench.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/bench/columns.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/call_program.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kStartBench = "palpate bench start";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kVersion_ms = 10, kFirstTick_ms = 150;  // promised

// One job and what it took in each round.
struct Job {
  std::string name;
  Words words;
  bool touches = false;
  std::vector<double> wall_ms{}, first_tick_ms{};
  std::int64_t libraries = 0;
};

double quantileOf(const std::vector<double>& values, double q) {
  if (values.empty()) return kNan;
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  return quantile(sorted, q);
}

Column<Job> quantileColumn(const char* name, std::vector<double> Job::*values, const char* word, double q, Look look) {
  return {fmt::format("{}_{}_ms", name, word), [=](const Job& job) { return quantileOf(job.*values, q); },
          std::move(look)};
}

const Columns<Job>& startColumns() {
  static const Columns<Job> kColumns = {
      {"job", &Job::name, {"job", ""}},
      {"rounds", [](const Job& job) { return static_cast<std::int64_t>(job.wall_ms.size()); }},
      quantileColumn("first_tick", &Job::first_tick_ms, "quartile_1", 0.25, {}),
      quantileColumn("first_tick", &Job::first_tick_ms, "median", 0.5, {"first tick", "ms", 1}),
      quantileColumn("first_tick", &Job::first_tick_ms, "quartile_3", 0.75, {"3rd quartile", "ms", 1}),
      quantileColumn("wall", &Job::wall_ms, "quartile_1", 0.25, {}),
      quantileColumn("wall", &Job::wall_ms, "median", 0.5, {"whole run", "ms", 1}),
      quantileColumn("wall", &Job::wall_ms, "quartile_3", 0.75, {"3rd quartile", "ms", 1}),
      {"libraries",
       [](const Job& job) -> BenchFigure { return job.touches ? BenchFigure(job.libraries) : BenchFigure(kNan); },
       {"libraries", ""}}};
  return kColumns;
}

// Throws unless it ends with status 0.
void runOrThrow(const std::string& program, const Words& words) {
  const ProgramEnd end = callProgram({.words = words, .program = program, .shows_messages = false});
  throwIfInterrupted(kStartBench);
  if (end.failure.empty()) return;
  throw Error(Error::Code::kDevice, fmt::format("palpate {}", fmt::join(words, " ")), "it failed in the bench",
              "run it by itself to see why");
}

class StartBench {
 public:
  explicit StartBench(const StartBenchRequest& request) : request_(request) {
    const std::string phantom = "phantom:sphere";
    jobs_ = {{.name = "--version", .words = {"--version"}}, {.name = "help", .words = {"help"}}};
    addTouch("touch phantom:sphere", phantom, {});
    addTouch("the same, edited", phantom, {"--edit", "remove:radius=2mm"});
    addTouch("the same, god-object", phantom, {"--algorithm", "god-object"});
    for (const char* format : {".vdb", ".nii", ".nrrd"}) {
      const std::string file = (folder_.path() / (std::string("sphere") + format)).string();
      runOrThrow(request_.program, {"convert", phantom, file});
      addTouch(std::string("touch sphere") + format, file, {});
    }
  }

  BenchResult run(Progress& progress) {
    BenchResult result = beginBench("start");
    progress.stage("starting the program again and again");
    for (int round = -1; round < request_.rounds; ++round) {
      progress.fraction(std::max(0, round) / static_cast<double>(request_.rounds));
      for (std::size_t n = 0; n < jobs_.size(); ++n)
        runJob(jobs_[(n + static_cast<std::size_t>(round + 1)) % jobs_.size()], round >= 0);
    }
    result.vulkan_device = vulkan_device_;
    for (const Job& job : jobs_) {
      BenchRow row = {{"part", "start"}};
      addFigures(row, startColumns(), job);
      result.rows.push_back(std::move(row));
    }
    promise(result,
            {"--version, median [ms]", kVersion_ms, "start", {{"job", "--version"}}, {"wall_median_ms"}, firstOf});
    promise(result, {"touch phantom:sphere to its first tick, median [ms]",
                     kFirstTick_ms,
                     "start",
                     {{"job", "touch phantom:sphere"}},
                     {"first_tick_median_ms"},
                     firstOf});
    return result;
  }

 private:
  void addTouch(const std::string& name, const std::string& volume, const Words& more) {
    Words words = {"touch",     volume, "--seconds", "0.05",
                   "--picture", "off",  "--out",     (folder_.path() / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    jobs_.push_back({.name = name, .words = std::move(words), .touches = true});
  }

  void runJob(Job& job, bool counts) {
    const Stopwatch watch;
    runOrThrow(request_.program, job.words);
    const double wall_ms = 1e3 * watch.seconds();
    if (!counts) return;
    job.wall_ms.push_back(wall_ms);
    if (!job.touches) return;
    std::ifstream file(folder_.path() / "out" / "summary.json");
    const auto summary = nlohmann::json::parse(file);
    vulkan_device_ = summary.at("vulkan").at("device");
    job.first_tick_ms.push_back(summary.at("servo").at("start_to_first_tick_ms"));
    job.libraries = static_cast<std::int64_t>(summary.at("libraries").size());
  }

  StartBenchRequest request_;
  ScratchFolder folder_;
  std::vector<Job> jobs_;
  std::string vulkan_device_;  // of the touches
};

}  // namespace

BenchResult runStartBench(const StartBenchRequest& request, Progress& progress) {
  return StartBench(request).run(progress);
}

std::string startTable(const BenchResult& result) {
  return tableText(result, {{"start"}, shown(startColumns())});
}

LogCharts startCharts(const BenchResult& result) {
  ChartPanel panel{"median times", "libraries loaded [-]", "to the first tick [ms]", {}};
  for (const BenchRow* row : rowsOf(result, "start")) {
    if (!std::isfinite(figureOf(*row, "first_tick_median_ms"))) continue;
    panel.series.push_back(
        {textOf(*row, "job"), {{figureOf(*row, "libraries"), figureOf(*row, "first_tick_median_ms")}}});
  }
  return {{"Start", {panel}, ChartMarks::kPoints}};
}

}  // namespace palpate
