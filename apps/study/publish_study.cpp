// SPDX-License-Identifier: Apache-2.0
// The study of publishing: window size x rate, against latency and the engine's time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/tick_cost.hpp"
#include "apps/sampled/window_follower.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/shrinking_ball.hpp"
#include "apps/study/studies.hpp"
#include "apps/study/study_gpu.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/window_pass.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr int kUsualWindow = kWindowEdge;
constexpr int kUsualRate_hz = 1000;  // about: the engine's thread looks at the tool every millisecond
constexpr double kSlow_m_per_s = 0.05, kQuick_m_per_s = 0.5;
constexpr int kDelivery_ticks = 1;  // from the gathering to the servo's next tick

struct Publishing {
  int window_voxels = kUsualWindow;
  int rate_hz = kUsualRate_hz;
  double speed_m_per_s = kSlow_m_per_s;
  std::string algorithm = "hri";
  [[nodiscard]] int period_ticks() const { return static_cast<int>(kBenchRate_hz) / rate_hz; }
};

// What the servo felt along the way.
struct Felt {
  std::vector<double> force_percent, angle_deg, age_ms;
  std::int64_t missed_ticks = 0;
};

// The windows on their way: gathered at some tick, with the servo from the next one on.
class Windows {
 public:
  Windows(const ShrinkingBall& ball, const Publishing& publishing) : ball_(ball), publishing_(publishing) {}

  // Gathers at the ticks of the rate; the newest one that has arrived.
  const SampleWindow& at(std::int64_t tick, const Vec3& place_W) {
    if (next_ && tick >= next_tick_ + kDelivery_ticks) {
      std::swap(storage_, next_storage_);
      current_ = *next_;
      current_.samples = storage_.data();
      current_tick_ = next_tick_;
      next_.reset();
    }
    if (tick % publishing_.period_ticks() == 0) {
      next_ = windowOf(ball_, static_cast<double>(tick) / kBenchRate_hz, place_W, publishing_.window_voxels, ++version_,
                       next_storage_);
      next_tick_ = tick;
    }
    if (current_.version == 0) {  // the first is there before the servo starts
      current_ = *next_;
      storage_ = next_storage_;
      current_.samples = storage_.data();
    }
    return current_;
  }
  [[nodiscard]] std::int64_t age_ticks(std::int64_t tick) const { return tick - current_tick_; }

 private:
  const ShrinkingBall& ball_;
  const Publishing& publishing_;
  std::vector<Sample> storage_, next_storage_;
  SampleWindow current_;
  std::optional<SampleWindow> next_;
  std::int64_t current_tick_ = 0, next_tick_ = 0;
  std::uint64_t version_ = 0;
};

Felt slide(const Publishing& publishing, double seconds) {
  const ShrinkingBall ball;
  const BallTool tool{.speed_m_per_s = publishing.speed_m_per_s};
  const auto haptic = makeAlgorithm(
      publishing.algorithm,
      {.parameters = {.isovalue = 0, .stiffness_N_per_m = kBenchStiffness_N_per_m, .damping_Ns_per_m = 0}});
  Windows windows(ball, publishing);
  Felt felt;
  TickOutput out;
  Vec3 last_W = tool.positionAt_W(ball, 0);
  haptic->reset(last_W);
  const auto begin = static_cast<std::int64_t>(2 * BallTool::kApproach_s * kBenchRate_hz);
  for (std::int64_t tick = 0; tick < begin + static_cast<std::int64_t>(seconds * kBenchRate_hz); ++tick) {
    const double t_s = static_cast<double>(tick) / kBenchRate_hz;
    const Vec3 hip_W = tool.positionAt_W(ball, t_s);
    const Vec3 velocity_W = (hip_W - last_W) * kBenchRate_hz;
    last_W = hip_W;
    haptic->tick({hip_W, velocity_W, &windows.at(tick, windowPlace(out, hip_W))}, out);
    if (tick < begin) continue;
    const Vec3 exact_N = kBenchStiffness_N_per_m * tool.depth_m * tool.directionAt(ball, t_s);
    felt.force_percent.push_back(100 * std::abs(out.force_W.norm() - exact_N.norm()) / exact_N.norm());
    felt.age_ms.push_back(1e3 / kBenchRate_hz * static_cast<double>(windows.age_ticks(tick)));
    felt.missed_ticks += hasContact(out) ? 0 : 1;
    if (!hasContact(out)) continue;
    felt.angle_deg.push_back(angleBetween_deg(out.force_W, exact_N));
  }
  return felt;
}

// A ball's samples on the device, from which windows are gathered.
struct GatherVolume {
  explicit GatherVolume(StudyGpu& on)
      : volume(makeVolume(*makePhantom("phantom:sphere?size=64"))),
        pool(on.gpu, on.transfer, volume),
        store(on.gpu, pool.brickCount(), allBricks(pool.grid())),
        pass(on.gpu, pool, store),
        window(on.gpu, "window", std::size_t{kWindowEdge} * kWindowEdge * kWindowEdge * sizeof(Sample),
               gpu::MemoryKind::kHost) {
    GradientPass(on.gpu, on.transfer, pool, store).run();
  }
  Volume volume;
  BrickPool pool;
  SampleStore store;
  WindowPass pass;
  gpu::Buffer window;
};

class PublishStage {
 public:
  explicit PublishStage(const StudySettings& settings) : settings_(settings) {}

  CellFigures run(const Publishing& publishing) {
    const Felt felt = slide(publishing, settings_.quick ? 0.3 : 0.7);
    const Percentiles force = percentiles(felt.force_percent), angle = percentiles(felt.angle_deg),
                      age = percentiles(felt.age_ms);
    const double gather_ms = gather(publishing.window_voxels);
    return {{{"window_age_median_ms", age.p50},
             {"window_age_max_ms", age.max},
             {"force_error_median_percent", force.p50},
             {"force_error_p99_percent", force.p99},
             {"force_angle_median_deg", angle.p50},
             {"missed_ticks", felt.missed_ticks}},
            {{"gather_ms", gather_ms}, {"engine_load_percent", 0.1 * gather_ms * publishing.rate_hz}}};
  }

 private:
  // The mean time in which the device gathers a window of this size [ms].
  double gather(int edge) {
    if (!on_) on_ = std::make_unique<GatherVolume>(gpu_.of(settings_.gpu));
    constexpr int kWindows = 8;
    const Vec3i last = on_->volume.size() - Vec3i::Constant(edge);
    const Stopwatch watch;
    for (int i = 0; i < kWindows; ++i) {
      const Vec3i first = last * i / (kWindows - 1);
      on_->pass.run({first, Vec3i::Constant(edge)}, on_->window);
    }
    return 1e3 * watch.seconds() / kWindows;
  }

  StudySettings settings_;
  LazyGpu gpu_;
  std::unique_ptr<GatherVolume> on_;
};

// Algorithms that hold a surface which is in the window, and so can follow one that changes.
std::vector<std::string> followers() {
  std::vector<std::string> names;
  for (const AlgorithmEntry& entry : algorithms()) {
    if (entry.traits.shows_surface && !entry.needs.isosurface_mesh) names.emplace_back(entry.name);
  }
  return names;
}

std::vector<StudyCell> publishCells(const StudySettings& settings) {
  const auto stage = std::make_shared<PublishStage>(settings);
  std::vector<StudyCell> cells;
  const auto add = [&](const Publishing& publishing) {
    cells.push_back({{{"algorithm", publishing.algorithm},
                      {"window_voxels", std::int64_t{publishing.window_voxels}},
                      {"rate_hz", std::int64_t{publishing.rate_hz}},
                      {"speed_m_per_s", publishing.speed_m_per_s},
                      {"window", fmt::format("{}^3", publishing.window_voxels)},
                      {"rate", fmt::format("{} Hz", publishing.rate_hz)}},
                     [=] { return stage->run(publishing); }});
  };
  const std::vector<int> rates = settings.quick ? std::vector{1000, 250, 50} : std::vector{1000, 500, 250, 125, 50, 25};
  const std::string standard = Scene{}.algorithm;
  for (const double speed : {kSlow_m_per_s, kQuick_m_per_s}) {
    for (const int window : {12, 16, 24, kUsualWindow}) {
      for (const int rate : rates) add({window, rate, speed, standard});
    }
  }
  for (const std::string& algorithm : followers()) {
    for (const int rate : rates) {
      if (algorithm != standard) add({kUsualWindow, rate, kSlow_m_per_s, algorithm});
    }
  }
  return cells;
}

std::vector<StudyPlot> publishPlots(bool /*quick*/) {
  const std::string standard = Scene{}.algorithm;
  const auto against_load = [&](const char* title, double speed) {
    return StudyPlot{
        .title = title,
        .like = {{"algorithm", standard}, {"speed_m_per_s", speed}},
        .x = "engine_load_percent",
        .x_label = "time of the engine's thread [%]",
        .y = "force_error_p99_percent",
        .y_label = "error of the force, p99 [%]",
        .series = {"window"},
        .labels = {"rate"},
        .standard = {{"window_voxels", std::int64_t{kUsualWindow}}, {"rate_hz", std::int64_t{kUsualRate_hz}}},
        .own = "window"};
  };
  const auto against_age = [&](const char* title, BenchRow like, const char* series) {
    return StudyPlot{.title = title,
                     .like = std::move(like),
                     .x = "window_age_median_ms",
                     .x_label = "age of the window that the servo has, median [ms]",
                     .y = "force_error_median_percent",
                     .y_label = "error of the force, median [%]",
                     .series = {series},
                     .labels = {},
                     .front = false,
                     .lines = {{"recession x age / depth", [](double age_ms) {
                                  return 100 * ShrinkingBall{}.speed_m_per_s * 1e-3 * age_ms / BallTool{}.depth_m;
                                }}}};
  };
  return {against_load("0.05 m/s", kSlow_m_per_s), against_load("0.5 m/s", kQuick_m_per_s),
          against_age("latency, window sizes", {{"algorithm", standard}, {"speed_m_per_s", kSlow_m_per_s}}, "window"),
          against_age("latency, algorithms",
                      {{"window_voxels", std::int64_t{kUsualWindow}}, {"speed_m_per_s", kSlow_m_per_s}}, "algorithm")};
}

// The depth is wrong by what the surface receded while the window grew old, less what trilinear interpolation puts the
// surface inward, some h^2 / (6 R): a fifth of a percent of the depth. From 2 ms on the first is at least ten times
// that.
std::vector<StudyOrder> publishOrders(bool /*quick*/) {
  return {{.what = "error of the force against the age of the window",
           .like = {{"speed_m_per_s", kSlow_m_per_s}, {"window_voxels", std::int64_t{kUsualWindow}}},
           .family = {"algorithm"},
           .x = "window_age_median_ms",
           .y = "force_error_median_percent",
           .least = 2,
           .theory = [](const BenchRow& row) {
             return textOf(row, "algorithm") == "hri" ? 1.0 : std::numeric_limits<double>::quiet_NaN();
           }}};
}

constexpr const char* kPublishWords = R"(
A ball of 20 mm whose surface recedes by 10 mm/s, as under a drill, with voxels of 0.5 mm; a tool slides over it, 1 mm below the
surface as it is, at 0.05 or 0.5 m/s.
Windows of so many samples along an edge are gathered at a fixed rate around the place that the servo asks for, show the ball
as it is then, and reach the servo a tick later.
Errors of the force are against K times the true depth; a tick without contact counts as 100 %.
The time of the engine's thread is the rate times what the device takes to gather such a window.
Samples are computed from the formula, so the servo's part is the same on every machine.)";

}  // namespace

Study publishStudy() {
  return {.name = "publishing",
          .title = "Publishing: error of the force against latency",
          .words = asParagraph(kPublishWords),
          .on_gpu = true,
          .rounds = 5,
          .seconds = 90,
          .quick_seconds = 15,
          .cells = publishCells,
          .plots = publishPlots,
          .orders = publishOrders,
          .counts = {"missed_ticks"},
          .counts_by = {"algorithm", "window", "speed_m_per_s"}};
}

}  // namespace palpate
