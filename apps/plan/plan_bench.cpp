// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/plan_bench.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/head_volume.hpp"
#include "apps/plan/counted_run.hpp"
#include "apps/plan/feature.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

constexpr double kBytesPerMiB = 1048576.0;
constexpr double kLessMemory = 1.0 / 5, kSoonerStart = 1.0 / 3;  // promised: the bare touch, over everything at once
constexpr const char* kBare = "bare touch";
constexpr const char* kLadder = "ladder";
constexpr const char* kAlone = "alone";

// A scene of the bench and what its runs found.
struct Rung {
  std::string part, feature, example;
  Scene scene;
  std::vector<RunCounts> runs = {};
};

using Figure = double (*)(const RunCounts& run);

double quantileOf(const Rung& rung, Figure figure, double q) {
  std::vector<double> values;
  for (const RunCounts& run : rung.runs) values.push_back(figure(run));
  std::sort(values.begin(), values.end());
  return quantile(values, q);
}

Column<Rung> measured(const char* key, Figure figure, double q, Look look = {}) {
  return {key, [=](const Rung& rung) { return quantileOf(rung, figure, q); }, std::move(look)};
}

// The same in every run but for those that depend on when a window or an edit comes.
Column<Rung> counted(const char* key, std::int64_t (*count)(const RunCounts& run), Look look) {
  return {key, [=](const Rung& rung) { return count(rung.runs.back()); }, std::move(look)};
}

double startOf(const RunCounts& run) {
  return run.start_ms;
}
double gpuMemoryOf(const RunCounts& run) {
  return static_cast<double>(run.gpu.peak_bytes) / kBytesPerMiB;
}

const Columns<Rung>& planColumns() {
  static const Columns<Rung> kColumns = {
      {"feature", &Rung::feature, {"feature", ""}},
      {"example", &Rung::example, {"measured with", ""}},
      {"runs", [](const Rung& rung) { return static_cast<std::int64_t>(rung.runs.size()); }},
      measured("start_quartile_1_ms", startOf, 0.25),
      measured("start_median_ms", startOf, 0.5, {"first tick", "ms", 1}),
      measured("start_quartile_3_ms", startOf, 0.75, {"3rd quartile", "ms", 1}),
      measured("tick_median_us", [](const RunCounts& run) { return run.tick_us; }, 0.5, {"tick", "us", 2}),
      measured("gpu_peak_MiB", gpuMemoryOf, 0.5, {"GPU", "MiB", 2}),
      measured("main_peak_MiB", [](const RunCounts& run) { return static_cast<double>(run.main_bytes) / kBytesPerMiB; },
               0.5, {"main memory", "MiB", 0}),
      measured("wall_median_ms", [](const RunCounts& run) { return run.wall_ms; }, 0.5, {"whole run", "ms", 0}),
      counted("pipelines", [](const RunCounts& run) { return static_cast<std::int64_t>(run.gpu.kernels.size()); },
              {"pipelines", ""}),
      counted("dispatches", [](const RunCounts& run) { return static_cast<std::int64_t>(run.dispatches()); },
              {"dispatches", ""}),
      counted("effect_runs", [](const RunCounts& run) { return run.effect_runs; }, {"effects run", ""}),
      counted("threads", [](const RunCounts& run) { return static_cast<std::int64_t>(run.ownThreads()); },
              {"threads", ""}),
      counted("libraries", [](const RunCounts& run) { return static_cast<std::int64_t>(run.libraries.size()); },
              {"libraries", ""})};
  return kColumns;
}

std::vector<Rung> rungs(const PlanBenchRequest& request, const std::filesystem::path& folder) {
  Scene bare;
  bare.volume = request.volume.empty() ? headVolume() : request.volume;
  bare.gpu = request.gpu;
  bare = bareScene(bare);
  std::vector<Rung> all = {{.part = kLadder, .feature = kBare, .example = {}, .scene = bare}};
  Scene more = bare;
  for (const Feature& feature : features()) {
    if (!feature.adds) continue;
    feature.add(more, folder);
    all.push_back({.part = kLadder, .feature = feature.name, .example = feature.example, .scene = more});
  }
  for (const Feature& feature : features()) {
    Scene one = bare;
    feature.add(one, folder);
    all.push_back({.part = kAlone, .feature = feature.name, .example = feature.example, .scene = one});
  }
  return all;
}

// Of the bare touch, over everything at once.
void promiseShare(BenchResult& result, const std::string& what, const char* key, double bound) {
  const BenchRows ladder = rowsOf(result, kLadder);
  result.targets.push_back({what, figureOf(*ladder.front(), key) / figureOf(*ladder.back(), key), bound});
}

constexpr const char* kPlanIntroduction = R"(
This program touches a volume for a fifth of a second, again and again, each time as a process of its own, all scenes in
turns; medians.
The ladder begins with a bare touch and adds one feature after another, up to everything at once; below it each feature
alone, beside the bare touch.
`first tick`: from the start of the process until the servo's first tick was due.
`tick`: computing time of a servo's tick, the median of a run.
`GPU`: the most that all buffers of the Vulkan device had at one time; the kept bricks of the volume are in it.
`pipelines`, `dispatches`, `effects run`, `threads`, `libraries`: counted by the running program (docs/summary.md).
The driver's cache of compiled kernels and the system's cache of files are warm.)";

}  // namespace

BenchResult runPlanBench(const PlanBenchRequest& request, Progress& progress) {
  const ScratchFolder folder;
  std::vector<Rung> all = rungs(request, folder.path());
  std::string device;
  progress.stage("touching with one feature more and more");
  const Stopwatch watch;
  const std::size_t count = all.size();
  const std::size_t runs = count * static_cast<std::size_t>(request.rounds + (request.warms_up ? 1 : 0));
  for (std::size_t n = 0; n < runs; ++n) {
    const std::size_t round = n / count;
    Rung& rung = all[(n + round) % count];
    RunCounts run = countedRun(rung.scene, folder.path(), request.program);
    device = run.vulkan_device;
    if (round > 0 || !request.warms_up) rung.runs.push_back(std::move(run));
    const double done = static_cast<double>(n + 1) / static_cast<double>(runs);
    progress.fraction(done, watch.seconds() * (1 - done) / done);
  }
  BenchResult result = beginBench("plan", device);
  for (const Rung& rung : all) {
    BenchRow row = {{"part", rung.part}, {"volume", std::filesystem::path(rung.scene.volume).filename().string()}};
    addFigures(row, planColumns(), rung);
    result.rows.push_back(std::move(row));
  }
  const std::string volume = textOf(result.rows.front(), "volume");
  promiseShare(result, fmt::format("GPU memory of a bare touch / of everything on, {} [-]", volume), "gpu_peak_MiB",
               kLessMemory);
  promiseShare(result, fmt::format("start of a bare touch / of everything on, {} [-]", volume), "start_median_ms",
               kSoonerStart);
  return result;
}

std::string planTable(const BenchResult& result) {
  return tableText(result, {{kLadder, kAlone}, shown(planColumns()), [](const BenchRow& row) {
                              return textOf(row, "part") == kLadder ? "each with all above it, " + textOf(row, "volume")
                                                                    : std::string("each alone");
                            }});
}

LogCharts planCharts(const BenchResult& result) {
  constexpr double kSeen = 1.05;  // a step by less has no name on the chart
  std::vector<ChartPanel> panels;
  for (const char* part : {kLadder, kAlone}) {
    const ChartPanel panel{part, "to the first tick [ms]", "GPU memory [MiB]", {}};
    const BenchRow* from = rowsOf(result, kLadder).front();
    for (const BenchRow* row : rowsOf(result, part)) {
      const auto stepOf = [&](const char* key) { return figureOf(*row, key) / figureOf(*from, key); };
      const bool is_seen = row == from || std::max(stepOf("start_median_ms"), stepOf("gpu_peak_MiB")) > kSeen;
      addPoint(panels, panel, part,
               {.x = figureOf(*row, "start_median_ms"),
                .y = figureOf(*row, "gpu_peak_MiB"),
                .label = is_seen ? textOf(*row, "feature") : std::string()});
      if (part == kLadder) from = row;  // alone: all beside the bare touch
    }
  }
  for (ChartSeries& series : panels.back().series) series.look = SeriesLook::kMarksAlone;
  return {{"What each feature costs", panels, ChartMarks::kPoints}};
}

Bench planBench() {
  return {.name = "plan",
          .help = "what each feature of a scene costs, from a bare touch to everything (minutes; --quick: one)",
          .title = "What each feature of a scene costs",
          .introduction = asParagraph(kPlanIntroduction),
          .takes = {"gpu"},
          .run =
              [](const Bench&, const BenchArguments& arguments, Progress& progress) {
                PlanBenchRequest request = arguments.quick ? PlanBenchRequest::quick() : PlanBenchRequest{};
                request.gpu = arguments.gpu;
                return runPlanBench(request, progress);
              },
          .table = planTable,
          .charts = planCharts};
}

}  // namespace palpate
