// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/edit_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/flat_volume.hpp"
#include "apps/bench/full_recompute.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/random.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/journal/journal_writer.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace {

constexpr const char* kEditBench = "palpate bench edit";
constexpr double kTargetRadius_voxel = 8;
constexpr std::size_t kRecomputes = 3;  // for each volume and radius; the one with a target gets more
constexpr std::size_t kTurn = 8;        // edits of one volume in a turn; they follow one another as those of a stroke

using flat_volume::kIsovalue;
using flat_volume::kPlane_voxel;
using flat_volume::kSpacing_m;

// The measurements of one volume at one radius.
struct EditCosts {
  std::int64_t size = 0;
  std::string gradients;
  double radius = 0;
  std::int64_t edits = 0, published = 0;
  std::vector<double> bricks, share_outside, recompute_ms;
  std::map<std::string, std::vector<double>> times_ms;  // of every edit, by stage
  double gpu_memory_MiB = 0;
  std::int64_t not_put_back = 0, seed = 0;

  [[nodiscard]] Percentiles of(const std::string& stage) const {
    const auto times = times_ms.find(stage);
    return times == times_ms.end() ? Percentiles{} : percentiles(times->second);
  }
};

struct Stage {
  const char* key;
  const char* charted;  // its name in the chart; "": not in the chart
  Look look;
};
const Stage kStages[] = {{"to_window", "to window", {"to win.", "ms", 3}},
                         {"plan", "plan", {"plan", "ms", 3}},
                         {"record", "record", {"record", "ms", 3}},
                         {"submit_and_wait", "submit, wait", {"wait", "ms", 3}},
                         {"edit_kernel", "edit kernel", {"edit", "ms", 3}},
                         {"bounds_kernel", "bounds kernel", {"bounds", "ms", 3}},
                         {"gradient_kernel", "gradient kernel", {"grad.", "ms", 3}},
                         {"window_kernel", "window kernel", {"window", "ms", 3}},
                         {"publish", "publish", {"publish", "ms", 3}},
                         {"settle", "", {"settle", "ms", 3}},
                         {"read_back", "VDB read-back", {"r.back", "ms", 3}},
                         {"journal", "", {"journal", "ms", 3}},
                         {"journal_saved", "journal on disk", {"on disk", "ms", 2}},
                         {"sum", "", {"sum", "ms", 3}}};

Columns<EditCosts> stageColumns() {
  Columns<EditCosts> columns;
  for (const Stage& stage : kStages) {
    const Look p99 = &stage == kStages ? Look("p99", "ms", 3) : Look();
    columns = joined(columns, percentileColumns<EditCosts>(
                                  stage.key, "ms", [key = stage.key](const EditCosts& f) { return f.of(key); },
                                  {{"median", &Percentiles::p50, stage.look}, {"p99", &Percentiles::p99, p99}}));
  }
  return columns;
}

const Columns<EditCosts>& editColumns() {
  static const Columns<EditCosts> kColumns = joined(
      Columns<EditCosts>{{"volume_voxel", &EditCosts::size},
                         {"gradients", &EditCosts::gradients},
                         {"radius_voxel", &EditCosts::radius, {"radius", "voxel"}},
                         {"edits", &EditCosts::edits},
                         {"windows_published", &EditCosts::published},
                         {"changed_bricks_median", [](const auto& f) { return median(f.bricks); }, {"bricks", ""}}},
      stageColumns(),
      Columns<EditCosts>{
          {"recomputes", [](const auto& f) { return static_cast<std::int64_t>(f.recompute_ms.size()); }},
          {"recompute_median_ms", [](const auto& f) { return percentiles(f.recompute_ms).p50; }, {"anew", "ms", 2}},
          {"recompute_p99_ms", [](const auto& f) { return percentiles(f.recompute_ms).p99; }},
          {"recompute_over_edit",
           [](const auto& f) { return percentiles(f.recompute_ms).p50 / f.of("to_window").p50; },
           {"times", "dearer", 0}},
          {"share_outside_kernels", [](const auto& f) { return median(f.share_outside); }, {"outside", "share", 2}},
          {"gpu_memory_MiB", &EditCosts::gpu_memory_MiB, {"GPU", "MiB", 0}},
          {"bricks_not_put_back", &EditCosts::not_put_back},
          {"seed", &EditCosts::seed}});
  return kColumns;
}

// One volume under edits.
class Session {
 public:
  Session(int size, bool all_gradients, const std::string& gpu)
      : size_(size),
        all_(all_gradients),
        volume_(flat_volume::make(size)),
        engine_(volume_, plan(), kIsovalue, gpu),
        recompute_(volume_, kIsovalue, all_gradients, gpu) {
    const std::vector<EditKind> kinds = {EditKind::kRemove, EditKind::kAdd};
    engine_.allowEdits(brushProfile(kIsovalue, 0, 1, Vec3::Constant(kSpacing_m)), kinds);
    static_cast<void>(engine_.publishAround(centre_W(), 1));
    const VolumeIdentity identity{volume_.facts().source, volume_.size(), volume_.lattice(), 0};
    journal_.emplace(folder_.path(), JournalHeader{identity, engine_.profile()});
  }

  [[nodiscard]] const gpu::GpuInfo& gpu() const { return engine_.gpu(); }
  [[nodiscard]] bool isAll() const { return all_; }
  [[nodiscard]] int size() const { return size_; }

  // Does and measures one edit at `offset_voxel` from the middle of the surface. Then puts the surface back.
  void edit(EditKind kind, const Vec3& offset_voxel, double radius_voxel, bool time_kernels) {
    EditCommand command;
    command.kind = kind;
    command.from_W = centre_W() + offset_voxel * kSpacing_m;
    command.to_W = command.from_W + Vec3(kSpacing_m, 0, 0);  // one voxel further: a piece of a stroke
    command.radius_m = radius_voxel * kSpacing_m;
    const std::span<const EditCommand> commands(&command, 1);
    const std::vector<BrickContent> before = contentOf(engine_.bricksToChange(commands));
    engine_.timeKernels(time_kernels);
    const Stopwatch watch;
    const Engine::EditResult result = engine_.edit(commands, 2);
    const double whole_ms = 1e3 * watch.seconds();
    const Stopwatch reading;
    static_cast<void>(engine_.readBack(volume_));
    const double read_back_ms = 1e3 * reading.seconds();
    note(result, whole_ms, read_back_ms, keep(commands), time_kernels);
    engine_.timeKernels(false);
    static_cast<void>(engine_.replace(before, 3));
    static_cast<void>(engine_.readBack(volume_));
  }

  void addRow(BenchResult& result, double radius_voxel, std::uint64_t seed) {
    figures_.size = size_;
    figures_.gradients = all_ ? "all" : "needed";
    figures_.radius = radius_voxel;
    figures_.gpu_memory_MiB = static_cast<double>(engine_.memory().back().bytes) / 1048576.0;
    figures_.not_put_back = notPutBack(radius_voxel);
    figures_.seed = static_cast<std::int64_t>(seed);
    addFigures(result.rows.emplace_back(BenchRow{{"part", "edit"}}), editColumns(), figures_);
    forget();
  }

  // Journals the edit as a session does, and returns the time on the engine's thread [ms]. Also measures the time until
  // the disk has confirmed the record, without the 3 ms in which a session gathers records.
  double keep(std::span<const EditCommand> commands) {
    const Stopwatch appending;
    journal_->edit(commands);
    const double ms = 1e3 * appending.seconds();
    figures_.times_ms["journal"].push_back(ms);
    journal_->flush();
    figures_.times_ms["journal_saved"].push_back(1e3 * appending.seconds());
    return ms;
  }

  void recompute() { figures_.recompute_ms.push_back(recompute_.run_ms()); }
  void forget() { figures_ = {}; }  // what was measured so far

 private:
  [[nodiscard]] Plan plan() const { return makePlan({.gradient_all = all_}); }
  [[nodiscard]] Vec3 centre_W() const {
    const int middle = size_ / 2;
    return Vec3(middle, middle, middle + kPlane_voxel) * kSpacing_m;
  }
  [[nodiscard]] std::vector<BrickContent> contentOf(const std::vector<std::uint32_t>& bricks) const {
    std::vector<BrickContent> contents;
    for (const std::uint32_t brick : bricks) contents.push_back(engine_.content(brick));
    return contents;
  }

  void note(const Engine::EditResult& result, double whole_ms, double read_back_ms, double journal_ms, bool timed) {
    std::map<std::string, double> ms;
    for (const StageTime& stage : result.stages) ms[stage.name] += stage.seconds * 1e3;
    const double to_window_ms = whole_ms - ms["settle"];
    ++figures_.edits;
    figures_.published += result.published ? 1 : 0;
    auto& times_ms = figures_.times_ms;
    if (timed) {
      const double kernels_ms = ms["edit"] + ms["bounds"] + ms["gradient"] + ms["window"];
      for (const char* kernel : {"edit", "bounds", "gradient", "window"}) {
        if (ms.contains(kernel)) times_ms[std::string(kernel) + "_kernel"].push_back(ms[kernel]);
      }
      times_ms["submit_and_wait"].push_back(ms["gpu"] - kernels_ms);
      if (kernels_ms > 0) figures_.share_outside.push_back(1 - kernels_ms / to_window_ms);
      return;
    }
    figures_.bricks.push_back(static_cast<double>(result.changed_bricks));
    for (const char* stage : {"plan", "record", "publish", "settle"}) times_ms[stage].push_back(ms[stage]);
    times_ms["to_window"].push_back(to_window_ms);
    times_ms["read_back"].push_back(read_back_ms);
    times_ms["sum"].push_back(whole_ms + read_back_ms + journal_ms);
  }

  // The number of bricks in reach of the edits whose values differ from the original ones.
  [[nodiscard]] std::int64_t notPutBack(double radius_voxel) const {
    std::int64_t wrong = 0;
    std::vector<float> now(kBrickVoxels), then(kBrickVoxels);
    const int reach = static_cast<int>(radius_voxel) / kBrickSize + 3;
    const Vec3i middle = Vec3i::Constant(size_ / 2 / kBrickSize);
    const Vec3i low = (middle - Vec3i::Constant(reach)).cwiseMax(0);
    const Vec3i high = (middle + Vec3i::Constant(reach)).cwiseMin(volume_.brickCount() - Vec3i::Ones());
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const bool constant = volume_.readBrick({x, y, z}, now.data());
          const bool was_constant = flat_volume::brick(size_, {x, y, z}, then.data());
          const auto count = constant ? 1 : kBrickVoxels;
          const bool same = constant == was_constant && std::equal(now.begin(), now.begin() + count, then.begin());
          wrong += same ? 0 : 1;
        }
      }
    }
    return wrong;
  }

  int size_;
  bool all_;
  Volume volume_;
  Engine engine_;
  FullRecompute recompute_;
  ScratchFolder folder_;
  std::optional<JournalWriter> journal_;  // in that folder
  EditCosts figures_;
};

class EditBench {
 public:
  EditBench(const EditBenchRequest& request, Progress& progress) : request_(request), progress_(progress) {
    for (const int size : request.sizes) open(size, false);
    open(request.all_size, true);
    const gpu::GpuInfo& gpu = sessions_[0]->gpu();
    result_ = beginBench("edit", fmt::format("{}, {}", gpu.name, gpu.driver));
  }

  BenchResult run() {
    for (const double radius : request_.radii) atRadius(radius);
    addTargets();
    return std::move(result_);
  }

 private:
  void open(int size, bool all) {
    throwIfInterrupted(kEditBench);
    progress_.stage(fmt::format("preparing {0} x {0} x {0} voxels", size));
    sessions_.push_back(std::make_unique<Session>(size, all, request_.gpu));
  }

  void atRadius(double radius) {
    progress_.stage(fmt::format("edits of radius {:g} voxels", radius));
    Random random(request_.seed);
    std::vector<std::pair<EditKind, Vec3>> edits;
    for (int n = 0; n < request_.repetitions; ++n) {
      // Anywhere within a brick, up to a quarter of the radius below or above the surface; the same for every volume.
      const Vec3 offset(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-0.25, 0.25) * radius);
      edits.emplace_back(n % 4 < 2 ? EditKind::kRemove : EditKind::kAdd, offset);
    }
    const auto one = [&](Session& session, std::size_t n) {
      throwIfInterrupted(kEditBench);
      session.edit(edits[n].first, edits[n].second, radius, n % 2 != 0);
    };
    for (const auto& session : sessions_) {  // warms up
      for (std::size_t n = 0; n < std::min<std::size_t>(4, edits.size()); ++n) one(*session, n);
      session->forget();
    }
    std::size_t first_session = 0, turns = 0;
    for (std::size_t first = 0; first < edits.size(); first += kTurn) {
      progress_.fraction(static_cast<double>(first) / static_cast<double>(edits.size()));
      for (std::size_t s = 0; s < sessions_.size(); ++s) {
        Session& session = *sessions_[(s + first_session) % sessions_.size()];
        for (std::size_t n = first; n < std::min(first + kTurn, edits.size()); ++n) one(session, n);
      }
      ++first_session;
      for (const auto& session : sessions_) {
        const bool judged = session->isAll() && radius == kTargetRadius_voxel && turns % 2 == 0;
        if (turns < kRecomputes || judged) session->recompute();
      }
      ++turns;
    }
    for (const auto& session : sessions_) session->addRow(result_, radius, request_.seed);
  }

  void addTargets();

  EditBenchRequest request_;
  Progress& progress_;
  std::vector<std::unique_ptr<Session>> sessions_;
  BenchResult result_;
};

void EditBench::addTargets() {
  if (std::find(request_.radii.begin(), request_.radii.end(), kTargetRadius_voxel) == request_.radii.end()) {
    return result_.note("no targets: radius 8 was left out");
  }
  const auto like = [](int size, const char* gradients) {
    return BenchRow{
        {"volume_voxel", std::int64_t{size}}, {"gradients", gradients}, {"radius_voxel", kTargetRadius_voxel}};
  };
  const auto toWindow_ms = [&](int size) {
    const BenchRows rows = rowsOf(result_, "edit", like(size, "needed"));
    return rows.empty() ? std::nan("") : figureOf(*rows.front(), "to_window_median_ms");
  };
  for (const int size : request_.sizes) {
    result_.targets.push_back(
        {fmt::format("edit to published window, {}^3, radius 8 voxels, median [ms]", size), toWindow_ms(size), 3});
  }
  if (const double ratio = toWindow_ms(1024) / toWindow_ms(64); !std::isnan(ratio)) {
    result_.rows.push_back({{"part", "ratio"}, {"edit_1024_over_64", ratio}});
    result_.targets.push_back({"the same, 1024^3 / 64^3 [-]", ratio, 1.2});
  }
  const int all = request_.all_size;
  promise(result_, {.name = fmt::format("edit / full recompute, {}^3, --gradient all [-]", all),
                    .bound = 1.0 / 50,
                    .part = "edit",
                    .like = like(all, "all"),
                    .keys = {"recompute_over_edit"},
                    .of = [](const std::vector<double>& values) { return 1 / values.front(); }});
  promise(result_, {.name = "share of an edit outside kernels, radius 8, worst volume [-]",
                    .bound = 0.5,
                    .part = "edit",
                    .like = {{"radius_voxel", kTargetRadius_voxel}},
                    .keys = {"share_outside_kernels"},
                    .of = largestOf});
}

std::string nameOf(const BenchRow& row) {
  return fmt::format("{:g}^3{}", figureOf(row, "volume_voxel"), textOf(row, "gradients") == "all" ? " all" : "");
}

}  // namespace

BenchResult runEditBench(const EditBenchRequest& request, Progress& progress) {
  return EditBench(request, progress).run();
}

std::string editTable(const BenchResult& result) {
  return tableText(result, {{"edit"}, joined(TableColumns{{"", nameOf, {"volume", ""}}}, shown(editColumns()))});
}

LogCharts editCharts(const BenchResult& result) {
  std::vector<ChartPanel> panels;
  for (const BenchRow* row : rowsOf(result, "edit")) {
    const std::string title = nameOf(*row) + (textOf(*row, "gradients") == "all" ? " gradients" : "");
    for (const Stage& stage : kStages) {
      if (*stage.charted == '\0') continue;
      addPoint(panels, {title, "brush radius [voxel]", "median time [ms]", {}}, stage.charted,
               {figureOf(*row, "radius_voxel"), figureOf(*row, std::string(stage.key) + "_median_ms")});
    }
  }
  return {{"One edit, by stage", panels, ChartMarks::kPoints}};
}

}  // namespace palpate
