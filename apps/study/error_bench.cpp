// SPDX-License-Identifier: Apache-2.0
#include "apps/study/error_bench.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/tick_cost.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/cell_runner.hpp"
#include "apps/study/merge_parts.hpp"
#include "apps/study/study_analysis.hpp"
#include "apps/study/study_chart.hpp"
#include "apps/study/study_report.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/passes/window_pass.hpp"

namespace palpate {
namespace {

constexpr const char* kErrorIntroduction = R"(
What a choice costs and how wrong it is, for every part of the program and beside its rivals, on the same axes.
Truth is a formula everywhere: the surface of a phantom, or the derivative of a sum of waves.
Each study is a list of cells; rounds go over all of them in an order drawn anew each time, and a cost is the median of its
rounds; the first round, which makes what cells need, does not count.
Errors must be the same in every round.
A choice is on the Pareto front if no other one of the plot costs less and errs less; the page says of each default whether
it is, and what beats it.
A choice is beaten in one plot at a time: what it is worth in another does not count there.
Orders of convergence are slopes of least squares in double logarithm, over the range in which the theory's leading term
rules.)";

// "cost_ns", "cost_ns_quartile_1", "cost_ns_quartile_3", "cost_ns_each".
void addCost(BenchRow& row, const std::string& key, const std::vector<double>& each) {
  const Spread spread = spreadOf(each);
  row.emplace_back(key, spread.median);
  row.emplace_back(key + "_quartile_1", spread.low);
  row.emplace_back(key + "_quartile_3", spread.high);
  row.emplace_back(key + "_each", fmt::format("{:.6g}", fmt::join(each, " ")));
}

// A study's cells as they are numbered in the whole list.
struct Listed {
  const Study* study = nullptr;
  std::vector<StudyCell> cells;
  std::size_t first = 0;  // the number of its first cell
};

class ErrorBench {
 public:
  ErrorBench(const ErrorBenchRequest& request, Progress& progress) : request_(request), progress_(progress) {
    for (const Study& study : studies()) {
      const auto& names = request.studies;
      if (!names.empty() && std::find(names.begin(), names.end(), study.name) == names.end()) continue;
      list_.push_back({&study, study.cells(request.settings), cells_});
      cells_ += list_.back().cells.size();
    }
    const bool needs_gpu = std::any_of(list_.begin(), list_.end(), [](const Listed& one) { return one.study->on_gpu; });
    std::optional<gpu::Gpu> device;
    if (needs_gpu) device.emplace(gpu::GpuRequest{.name = request.settings.gpu});
    result_ = beginBench("error", device ? fmt::format("{}, {}", device->info().name, device->info().driver) : "none");
    addShardRow();
  }

  BenchResult run() {
    const KeptWork kept;  // Ctrl-C keeps what was measured
    for (std::size_t i = 0; i < list_.size() && !result_.stopped; ++i) runStudy(i);
    analyse(result_);
    return std::move(result_);
  }

 private:
  void addShardRow() {
    std::vector<std::string> names;
    for (const Listed& one : list_) names.emplace_back(one.study->name);
    result_.rows.push_back({{"part", "shard"},
                            {"shard", std::int64_t{request_.shard.number}},
                            {"shards", std::int64_t{request_.shard.of}},
                            {"quick", request_.settings.quick ? "yes" : "no"},
                            {"seed", static_cast<std::int64_t>(request_.settings.seed)},
                            {"studies", fmt::format("{}", fmt::join(names, " "))},
                            {"cells", static_cast<std::int64_t>(cells_)},
                            {"machine", result_.machine},
                            {"vulkan_device", result_.vulkan_device}});
  }

  [[nodiscard]] double secondsOf(const Study& study) const {
    return request_.settings.quick ? study.quick_seconds : study.seconds;
  }

  // The cells of this study that belong to the shard.
  [[nodiscard]] std::vector<std::size_t> ownCells(const Listed& listed) const {
    std::vector<std::size_t> own;
    for (const std::size_t cell : cellsOf(request_.shard, cells_)) {
      if (cell >= listed.first && cell < listed.first + listed.cells.size()) own.push_back(cell);
    }
    return own;
  }

  void runStudy(std::size_t which) {
    Listed& listed = list_[which];
    const Study& study = *listed.study;
    const std::vector<std::size_t> own = ownCells(listed);
    std::vector<const StudyCell*> cells;
    for (const std::size_t cell : own) cells.push_back(&listed.cells[cell - listed.first]);
    double later_s = 0;
    for (std::size_t i = which + 1; i < list_.size(); ++i) {
      later_s += secondsOf(*list_[i].study) / request_.shard.of;
    }
    const int rounds = request_.settings.quick ? study.quick_rounds : study.rounds;
    const auto tell = [&, shown = -1](const RunState& state) mutable {
      if (state.round != std::exchange(shown, state.round)) {
        progress_.stage(state.round == 0 ? fmt::format("{}: preparing", study.name)
                                         : fmt::format("{}: round {} of {}", study.name, state.round, rounds));
      }
      progress_.fraction(state.share, state.left_s + later_s);
    };
    const CellRuns runs = runCells(cells, {rounds, request_.settings.seed}, interrupted, tell);
    result_.stopped = runs.stopped;
    for (std::size_t i = 0; i < own.size(); ++i) addRow(study, *cells[i], own[i], runs.cells[i]);
    listed.cells.clear();  // and with them what they share, which may be large
  }

  void addRow(const Study& study, const StudyCell& cell, std::size_t number, const CellRun& run) {
    if (run.left_out.empty() && !run.measured()) return;
    BenchRow row = {{"part", study.name}};
    row.insert(row.end(), cell.parameters.begin(), cell.parameters.end());
    row.emplace_back("cell", static_cast<std::int64_t>(number));
    row.emplace_back("shard", std::int64_t{request_.shard.number});
    if (run.left_out.empty()) {
      row.insert(row.end(), run.errors.begin(), run.errors.end());
      row.emplace_back("errors_repeat", run.repeats ? "yes" : "no");
      for (const auto& [key, each] : run.costs) addCost(row, key, each);
    } else {
      row.emplace_back("left_out", run.left_out);
    }
    result_.rows.push_back(std::move(row));
  }

  const ErrorBenchRequest& request_;
  Progress& progress_;
  std::vector<Listed> list_;
  std::size_t cells_ = 0;
  BenchResult result_;
};

}  // namespace

BenchResult runErrorBench(const ErrorBenchRequest& request, Progress& progress) {
  for (const std::string& name : request.studies) static_cast<void>(studyNamed(name));
  return ErrorBench(request, progress).run();
}

Bench errorBench() {
  const auto run = [](const Bench&, const BenchArguments& arguments, Progress& progress) {
    return runErrorBench({{arguments.quick, arguments.seed, arguments.gpu},
                          arguments.studies,
                          arguments.shard.empty() ? Shard{} : shardOf(arguments.shard)},
                         progress);
  };
  const Scene scene;
  std::string introduction =
      asParagraph(kErrorIntroduction) +
      fmt::format(
          "\n\n**Defaults of the program.** Gradient operator `{}`, samples as `{}`, algorithm `{}` with a plane "
          "every {} ticks, windows of {}^3 samples, {}.",
          scene.gradient_operator, scene.samples, scene.algorithm, scene.plane_renewal_ticks, kWindowEdge,
          scene.filter.empty() ? "no filter" : "filter " + scene.filter);
  for (const Study& study : studies()) introduction += fmt::format("\n\n**{}.** {}", study.title, study.words);
  return {.name = "error",
          .help = "error against run time of every part, beside its rivals (half an hour; --quick: two minutes)",
          .title = "Error against run time",
          .introduction = introduction,
          .takes = {"gpu", "studies", "shard"},
          .run = run,
          .table = errorTable,
          .charts = errorCharts,
          .report = errorReport,
          .merge = mergeParts};
}

}  // namespace palpate
