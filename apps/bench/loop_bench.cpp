// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/loop_bench.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "apps/bench/contact_path.hpp"
#include "apps/bench/cyclictest.hpp"
#include "apps/bench/entrants.hpp"
#include "apps/bench/lateness.hpp"
#include "apps/console/interrupt.hpp"
#include "engine/service/engine_thread.hpp"
#include "servo/devices/registry.hpp"
#include "servo/devices/sampled_path.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {
namespace {

constexpr const char* kLoopBench = "palpate bench loop";
constexpr int kRenewal = 5;
// Lower edges of the classes in which histograms are given [us].
constexpr std::array<std::int64_t, 26> kEdges_us = {0,    1,    2,    3,    5,    7,     10,    15,    20,
                                                    30,   50,   70,   100,  150,  200,   300,   500,   700,
                                                    1000, 1500, 2000, 3000, 5000, 10000, 20000, 100000};

// What all turns of one side at one rate add up to.
struct Side {
  LatenessCounts lateness;
  std::vector<double> p99_of_turn_us;

  void add(const LatenessCounts& turn) {
    lateness.add(turn);
    p99_of_turn_us.push_back(turn.quantile_us(0.99));
  }
};

struct LoopSide {
  Side side;
  std::vector<double> tick_cost_us, window_age_ms, plane_age_ticks, exact_lateness_us;
  std::int64_t skipped = 0, overruns = 0, windows = 0;
};

SampledPath asPath(const ContactPath& way) {
  std::vector<double> times_s;
  for (std::size_t k = 0; k < way.ticks(); ++k) times_s.push_back(static_cast<double>(k) / kBenchRate_hz);
  return {std::move(times_s), way.hip_W, SampledPath::Interpolation::kLinear};
}

// Moves the engine's tool along the path while no servo does. It runs, for nobody, in the loop's turns too: its waking
// every millisecond keeps a processor from falling asleep deeply, which alone made cyclictest look better (medians at
// 1 kHz of 37 and 27 us before, of 28 and 30 us since).
class Feeder {
 public:
  Feeder(const Path& path, ToolPoseMailbox& tool) : thread_([this, &path, &tool] { feed(path, tool); }) {}
  ~Feeder() { stop_ = true; }
  Feeder(const Feeder&) = delete;
  Feeder& operator=(const Feeder&) = delete;

 private:
  void feed(const Path& path, ToolPoseMailbox& tool) {
    const std::int64_t start_ns = monotonicNow_ns();
    for (std::int64_t tick = 0; !stop_; ++tick) {
      const std::int64_t now_ns = monotonicNow_ns();
      tool.back() = ToolPose{path.position(static_cast<double>(now_ns - start_ns) * 1e-9), Vec3::Zero(), tick, now_ns};
      tool.publish();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  std::atomic<bool> stop_ = false;
  std::jthread thread_;  // last: it uses the flag; joined first
};

BenchRow latenessRow(const char* part, double rate_hz, const Side& side) {
  std::vector<double> p99 = side.p99_of_turn_us;
  std::sort(p99.begin(), p99.end());
  const LatenessCounts& l = side.lateness;
  return {{"part", part},
          {"rate_hz", rate_hz},
          {"wakeups", l.total()},
          {"lateness_median_us", l.quantile_us(0.5)},
          {"lateness_p90_us", l.quantile_us(0.9)},
          {"lateness_p99_us", l.quantile_us(0.99)},
          {"lateness_p999_us", l.quantile_us(0.999)},
          {"lateness_max_us", l.quantile_us(1)},
          {"turn_p99_quartile_1_us", quantile(p99, 0.25)},
          {"turn_p99_median_us", quantile(p99, 0.5)},
          {"turn_p99_quartile_3_us", quantile(p99, 0.75)},
          {"deadline_misses", l.misses(rate_hz)}};
}

void addPercentiles(BenchRow& row, const std::string& name, const std::string& unit, std::vector<double> values) {
  const Percentiles p = percentiles(std::move(values));
  row.push_back({name + "_median_" + unit, p.p50});
  row.push_back({name + "_p99_" + unit, p.p99});
  row.push_back({name + "_p999_" + unit, p.p999});
  row.push_back({name + "_max_" + unit, p.max});
}

void addHistogram(BenchResult& result, const char* side, double rate_hz, const LatenessCounts& lateness) {
  for (std::size_t i = 0; i < kEdges_us.size(); ++i) {
    const std::int64_t end_us = i + 1 < kEdges_us.size() ? kEdges_us[i + 1] : LatenessCounts::kOverflow_us;
    const std::int64_t later = i + 1 < kEdges_us.size() ? lateness.atLeast(end_us) : 0;
    const std::int64_t count = lateness.atLeast(kEdges_us[i]) - later;
    if (count == 0) continue;
    result.rows.push_back({{"part", "histogram"},
                           {"side", side},
                           {"rate_hz", rate_hz},
                           {"lateness_from_us", kEdges_us[i]},
                           {"lateness_to_us", end_us},
                           {"wakeups", count},
                           {"share_later", static_cast<double>(later) / static_cast<double>(lateness.total())}});
  }
}

class LoopBench {
 public:
  LoopBench(const LoopBenchRequest& request, Progress& progress)
      : request_(request), progress_(progress), volume_(request.volume), path_(makePath()), engine_(makeEngine()) {
    result_.bench = "loop";
    result_.machine = machineInWords();
    result_.vulkan_device = fmt::format("{}, {}", engine_->gpu().name, engine_->gpu().driver);
  }

  BenchResult run() {
    for (const double rate_hz : request_.rates_hz) atRate(rate_hz);
    return std::move(result_);
  }

 private:
  [[nodiscard]] SampledPath makePath() {
    progress_.stage("preparing");
    return asPath(contactPath(volume_, {.speed_m_per_s = request_.speed_m_per_s,
                                        .ticks = static_cast<std::size_t>(std::ceil(request_.turn_s * kBenchRate_hz)),
                                        .seed = request_.seed}));
  }

  [[nodiscard]] std::unique_ptr<Engine> makeEngine() const {
    return std::make_unique<Engine>(makeVolume(volume_.phantom()), makePlan({}), volume_.isovalue(), request_.gpu);
  }

  void atRate(double rate_hz) {
    const int turns = std::max(1, static_cast<int>(std::lround(request_.seconds / request_.turn_s)));
    progress_.stage(fmt::format("loop and cyclictest at {:g} Hz", rate_hz));
    LoopSide loop;
    Side cyclic;
    for (int turn = 0; turn < turns; ++turn) {
      progress_.fraction(static_cast<double>(turn) / turns);
      // A B, B A, A B ...: a load that grows or falls meets both alike.
      if (turn % 2 == 0) loopTurn(rate_hz, loop);
      cyclicTurn(rate_hz, cyclic);
      if (turn % 2 == 1) loopTurn(rate_hz, loop);
    }
    addRows(rate_hz, loop, cyclic);
  }

  void loopTurn(double rate_hz, LoopSide& side) {
    throwIfInterrupted(kLoopBench);
    const auto algorithm = makeAlgorithm("hri", {.parameters = {.isovalue = volume_.isovalue(),
                                                                .stiffness_N_per_m = kBenchStiffness_N_per_m,
                                                                .plane_renewal_ticks = kRenewal},
                                                 .effects = {}});
    const std::unique_ptr<Device> device = makeDevice(devices().front().name, {.path = &path_, .rate_hz = rate_hz});
    ToolPoseMailbox tool;
    LoopParameters parameters;
    parameters.rate_hz = rate_hz;
    parameters.ticks = std::llround(request_.turn_s * rate_hz);
    parameters.priority = request_.priority;
    ServoLoop loop(parameters, *algorithm, *device, engine_->exchange(), tool);
    engine_->publishAround(tool.latest().position_W, monotonicNow_ns());
    EngineThread publisher(*engine_, tool);
    ToolPoseMailbox nobody;
    LoopResult result;
    {
      const Feeder as_in_the_other_turn(path_, nobody);
      loop.start();
      result = loop.wait();
    }
    publisher.stop();
    side.windows += static_cast<std::int64_t>(publisher.publications());
    fifo_ = result.real_time.fifo;
    for (const std::string& words : result.real_time.notes) {
      if (noted_.insert(words).second) result_.note(words);
    }
    addTurn(result, side);
  }

  static void addTurn(const LoopResult& result, LoopSide& side) {
    LatenessCounts turn;
    for (const TickRecord& record : result.records) {
      turn.add(record.lateness_ns / 1000);  // cut down to whole microseconds, as cyclictest does
      side.exact_lateness_us.push_back(static_cast<double>(record.lateness_ns) * 1e-3);
      side.tick_cost_us.push_back(record.tick_cost_ns * 1e-3);
      side.window_age_ms.push_back(static_cast<double>(record.window_age_ns) * 1e-6);
      side.plane_age_ticks.push_back(record.plane_age_ticks);
      side.overruns += has(record.faults, ServoFault::kOverrun) ? 1 : 0;
    }
    side.side.add(turn);
    side.skipped += result.ticks_skipped;
  }

  void cyclicTurn(double rate_hz, Side& side) {
    throwIfInterrupted(kLoopBench);
    if (no_cyclictest_) return;
    ToolPoseMailbox tool;
    EngineThread publisher(*engine_, tool);
    CyclictestOutcome outcome;
    {
      const Feeder feeder(path_, tool);
      outcome = runCyclictest({.rate_hz = rate_hz,
                               .cycles = std::llround(request_.turn_s * rate_hz),
                               .priority = request_.priority,
                               .fifo = fifo_});
    }
    publisher.stop();
    if (outcome.trouble.empty()) {
      side.add(outcome.lateness);
      return;
    }
    throwIfInterrupted(kLoopBench);  // Ctrl-C ends cyclictest too
    no_cyclictest_ = true;
    result_.note("no comparison: " + outcome.trouble);
  }

  void addRows(double rate_hz, LoopSide& loop, const Side& cyclic) {
    BenchRow row = latenessRow("loop", rate_hz, loop.side);
    row.push_back({"overrun_ticks", loop.overruns});
    row.push_back({"skipped_ticks", loop.skipped});
    row.push_back({"windows_published", loop.windows});
    row.push_back({"lateness_exact_p99_us", percentiles(std::move(loop.exact_lateness_us)).p99});
    addPercentiles(row, "tick_cost", "us", std::move(loop.tick_cost_us));
    addPercentiles(row, "window_age", "ms", std::move(loop.window_age_ms));
    addPercentiles(row, "plane_age", "ticks", std::move(loop.plane_age_ticks));
    row.push_back({"seed", static_cast<std::int64_t>(request_.seed)});
    result_.rows.push_back(std::move(row));
    addHistogram(result_, "loop", rate_hz, loop.side.lateness);
    if (no_cyclictest_) return;
    result_.rows.push_back(latenessRow("cyclictest", rate_hz, cyclic));
    addHistogram(result_, "cyclictest", rate_hz, cyclic.lateness);
    const double ratio = loop.side.lateness.quantile_us(0.99) / std::max(1.0, cyclic.lateness.quantile_us(0.99));
    result_.rows.push_back({{"part", "ratio"}, {"rate_hz", rate_hz}, {"loop_over_cyclictest_p99", ratio}});
    if (rate_hz != 1000) return;  // promised at 1 kHz only
    result_.targets.push_back({"lateness p99 at 1 kHz, loop / cyclictest [-]", ratio, 1.2});
    const auto theirs = static_cast<double>(cyclic.lateness.misses(rate_hz));
    result_.targets.push_back({"deadline misses at 1 kHz, loop (bound: cyclictest's) [-]",
                               static_cast<double>(loop.side.lateness.misses(rate_hz)), theirs});
  }

  LoopBenchRequest request_;
  Progress& progress_;
  BenchVolume volume_;
  SampledPath path_;
  std::unique_ptr<Engine> engine_;
  BenchResult result_;
  std::set<std::string> noted_;
  bool fifo_ = true;
  bool no_cyclictest_ = false;
};

}  // namespace

LoopBenchRequest LoopBenchRequest::quick() {
  LoopBenchRequest request;
  request.seconds = 2;
  request.turn_s = 0.5;
  return request;
}

BenchResult runLoopBench(const LoopBenchRequest& request, Progress& progress) {
  LoopBenchRequest fitted = request;
  fitted.turn_s = std::min(request.turn_s, request.seconds);
  return LoopBench(fitted, progress).run();
}

}  // namespace palpate
