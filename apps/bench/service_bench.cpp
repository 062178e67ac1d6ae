// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/service_bench.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/service_run.hpp"

namespace palpate {
namespace {

constexpr double kFirstPair_s = 0.5;  // which is not counted

const Columns<ServiceFigures>& runColumns() {
  using F = ServiceFigures;
  using P = Percentiles;
  const auto percentilesOf = [](const char* name, const char* unit, P F::*of,
                                const std::vector<PercentileWord>& words) {
    return percentileColumns<F>(
        name, unit, [of](const F& run) { return run.*of; }, words);
  };
  static const Columns<F> kColumns = joined(
      Columns<F>{{"ticks", &F::ticks},
                 {"skipped_ticks", &F::skipped_ticks},
                 {"stale_ticks", &F::stale_ticks},
                 {"windows", &F::windows},
                 {"edits", &F::edits},
                 {"unseen_edits", &F::unseen_edits}},
      percentilesOf("window_age", "ms", &F::window_age_ms, {{"median", &P::p50}, {"p99", &P::p99}, {"max", &P::max}}),
      percentilesOf("first_use", "us", &F::first_use_us, {{"median", &P::p50}, {"p99", &P::p99}}),
      percentilesOf("edit_to_window", "ms", &F::to_window_ms, {{"median", &P::p50}, {"p99", &P::p99}}),
      percentilesOf("tick_cost", "us", &F::tick_cost_us, {{"median", &P::p50}, {"p99", &P::p99}}),
      percentilesOf("lateness", "us", &F::lateness_us, {{"median", &P::p50}, {"p99", &P::p99}, {"p999", &P::p999}}));
  return kColumns;
}

Columns<ServiceRatio> spreadColumns(const std::string& name, Spread ServiceRatio::*of, const Look& median,
                                    const Look& low = {}, const Look& high = {}) {
  return {{name + "_median", [of](const ServiceRatio& ratio) { return (ratio.*of).median; }, median},
          {name + "_quartile_1", [of](const ServiceRatio& ratio) { return (ratio.*of).low; }, low},
          {name + "_quartile_3", [of](const ServiceRatio& ratio) { return (ratio.*of).high; }, high}};
}

const Columns<ServiceRatio>& ratioColumns() {
  using R = ServiceRatio;
  static const Columns<R> kColumns =
      joined(Columns<R>{{"figure", &R::figure, {"figure", ""}}}, spreadColumns("one", &R::one, {"one process", "", 2}),
             spreadColumns("two", &R::two, {"two", "", 2}),
             Columns<R>{{"ratio_median", [](const R& ratio) { return ratio.ratio.median; }, {"ratio", "", 3}},
                        {"ratio_from", &R::from, {"from", "", 3}},
                        {"ratio_to", &R::to, {"to", "", 3}},
                        {"ratio_quartile_1", [](const R& ratio) { return ratio.ratio.low; }, {"1st quartile", "", 3}},
                        {"ratio_quartile_3", [](const R& ratio) { return ratio.ratio.high; }, {"3rd", "", 3}},
                        {"ratio_least", &R::least},
                        {"ratio_most", &R::most}},
             spreadColumns("again", &R::again, {"one / one", "", 3}, {"1st quartile", "", 3}, {"3rd", "", 3}));
  return kColumns;
}

void addRun(BenchResult& result, std::size_t pair, Processes processes, const ServiceFigures& figures) {
  BenchRow row = {{"part", "run"}, {"pair", static_cast<std::int64_t>(pair)}, {"processes", wordFor(processes)}};
  addFigures(row, runColumns(), figures);
  result.rows.push_back(std::move(row));
}

// The figures as they are measured; what the system refused is noted once.
class ServiceTurns {
 public:
  ServiceTurns(const ServiceBenchRequest& request, BenchResult& result)
      : result_(result), runs_(request.volume, request.seconds, request.seed, request.gpu, request.commit) {}

  ServicePair pair(bool begins_with_one) {
    ServicePair pair;
    if (begins_with_one) pair.one = turn(Processes::kOne);
    pair.two = turn(Processes::kTwo);
    if (!begins_with_one) pair.one = turn(Processes::kOne);
    return pair;
  }
  [[nodiscard]] const std::string& vulkanDevice() const noexcept { return runs_.vulkanDevice(); }

 private:
  ServiceFigures turn(Processes processes) {
    const ServiceRun run = runs_.run(processes);
    for (const std::string& words : run.loop.real_time.notes) {
      if (noted_.insert(words).second) result_.note(fmt::format("{} processes: {}", wordFor(processes), words));
    }
    return serviceFigures(run.loop, runs_.rate_hz(), run.asked);
  }

  BenchResult& result_;
  ServiceRuns runs_;
  std::set<std::string> noted_;
};

}  // namespace

void addServicePairs(BenchResult& result, const std::vector<ServicePair>& pairs) {
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    addRun(result, n, Processes::kOne, pairs[n].one);
    addRun(result, n, Processes::kTwo, pairs[n].two);
  }
  for (const ServiceRatio& ratio : serviceRatios(pairs)) {
    addFigures(result.rows.emplace_back(BenchRow{{"part", "ratio"}}), ratioColumns(), ratio);
    if (!std::isfinite(ratio.bound)) continue;
    promise(result, {.name = ratio.figure.substr(0, ratio.figure.rfind(" [")) + ", two processes / one [-]",
                     .bound = ratio.bound,
                     .part = "ratio",
                     .like = {{"figure", ratio.figure}},
                     .keys = {"ratio_median"},
                     .of = firstOf});
  }
}

BenchResult runServiceBench(const ServiceBenchRequest& request, Progress& progress) {
  BenchResult result = beginBench("service");
  progress.stage("feeling " + request.volume + " in one process and in two");
  ServiceBenchRequest first = request;
  first.seconds = std::min(request.seconds, kFirstPair_s);
  static_cast<void>(ServiceTurns(first, result).pair(true));
  result.rows.clear();  // its notes come again
  ServiceTurns turns(request, result);
  std::vector<ServicePair> pairs;
  for (int n = 0; n < request.pairs; ++n) {
    progress.fraction(static_cast<double>(n) / request.pairs);
    pairs.push_back(turns.pair(n % 2 == 0));
  }
  result.vulkan_device = turns.vulkanDevice();
  addServicePairs(result, pairs);
  return result;
}

std::string serviceTable(const BenchResult& result) {
  std::string text = tableText(result, {{"ratio"}, shown(ratioColumns())});
  for (const Processes processes : {Processes::kOne, Processes::kTwo}) {
    const BenchRows runs = rowsOf(result, "run", {{"processes", wordFor(processes)}});
    const auto sum = [&](const char* key) {
      double all = 0;
      for (const BenchRow* run : runs) all += figureOf(*run, key);
      return all;
    };
    text += fmt::format(
        "{}: {} runs, {:g} ticks, {:g} left out, {:g} with a stale window, {:g} windows, {:g} edits, {:g} not seen\n",
        wordFor(processes), runs.size(), sum("ticks"), sum("skipped_ticks"), sum("stale_ticks"), sum("windows"),
        sum("edits"), sum("unseen_edits"));
  }
  return text;
}

LogCharts serviceCharts(const BenchResult& result) {
  constexpr std::pair<const char*, const char*> kPanels[] = {
      {"window age p99 [ms]", "window_age_p99_ms"},
      {"tick cost median [us]", "tick_cost_median_us"},
      {"tick cost p99 [us]", "tick_cost_p99_us"},
      {"edit to window median [ms]", "edit_to_window_median_ms"}};
  std::vector<ChartPanel> panels;
  const BenchRows ones = rowsOf(result, "run", {{"processes", wordFor(Processes::kOne)}});
  for (const auto& [title, key] : kPanels) {
    ChartPanel panel{title, "in one process", "in two", {{"pairs", {}}, {"alike", {}, SeriesLook::kDashed}}};
    for (const BenchRow* one : ones) {
      const BenchRow like = {{"processes", wordFor(Processes::kTwo)}, {"pair", *findFigure(*one, "pair")}};
      const double x = figureOf(*one, key);
      for (const BenchRow* two : rowsOf(result, "run", like))
        panel.series[0].points.push_back({x, figureOf(*two, key)});
      panel.series[1].points.push_back({x, x});
    }
    std::ranges::sort(panel.series[1].points, {}, &ChartPoint::x);
    panels.push_back(std::move(panel));
  }
  return {{"Engine and servo in two processes", panels, ChartMarks::kPoints}};
}

}  // namespace palpate
