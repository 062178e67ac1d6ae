// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/edit_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/flat_volume.hpp"
#include "apps/bench/full_recompute.hpp"
#include "apps/bench/random.hpp"
#include "apps/bench/scratch_folder.hpp"
#include "apps/console/interrupt.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/gpu/gpu_info.hpp"
#include "engine/journal/journal_writer.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace {

constexpr const char* kEditBench = "palpate bench edit";
constexpr double kTargetRadius_voxel = 8;
constexpr std::size_t kRecomputes = 3;  // of each volume and radius; more of what the target is about
constexpr std::size_t kTurn = 8;  // edits of one volume before the next has its turn, as a stroke's follow one another

using flat_volume::kIsovalue;
using flat_volume::kPlane_voxel;
using flat_volume::kSpacing_m;

// Milliseconds of every edit, by stage.
using Times = std::map<std::string, std::vector<double>>;

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

  // `offset_voxel` from the middle of the surface. One edit; then the surface is put back.
  void edit(EditKind kind, const Vec3& offset_voxel, double radius_voxel, bool time_kernels) {
    EditCommand command;
    command.kind = kind;
    command.from_W = centre_W() + offset_voxel * kSpacing_m;
    command.to_W = command.from_W + Vec3(kSpacing_m, 0, 0);  // a voxel on: a piece of a stroke
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
    BenchRow row = {{"part", "edit"},
                    {"volume_voxel", std::int64_t{size_}},
                    {"gradients", all_ ? "all" : "needed"},
                    {"radius_voxel", radius_voxel},
                    {"edits", edits_},
                    {"windows_published", published_},
                    {"changed_bricks_median", median(bricks_)}};
    for (const char* stage :
         {"to_window", "plan", "record", "submit_and_wait", "edit_kernel", "bounds_kernel", "gradient_kernel",
          "window_kernel", "publish", "settle", "read_back", "journal", "journal_saved", "sum"}) {
      const Percentiles p = percentiles(times_[stage]);
      row.push_back({std::string(stage) + "_median_ms", p.p50});
      row.push_back({std::string(stage) + "_p99_ms", p.p99});
    }
    const Percentiles anew = percentiles(recompute_.times_ms());
    row.push_back({"recomputes", static_cast<std::int64_t>(recompute_.times_ms().size())});
    row.push_back({"recompute_median_ms", anew.p50});
    row.push_back({"recompute_p99_ms", anew.p99});
    row.push_back({"recompute_over_edit", anew.p50 / percentiles(times_["to_window"]).p50});
    row.push_back({"share_outside_kernels", median(share_outside_)});
    row.push_back({"gpu_memory_MiB", static_cast<double>(engine_.memory().back().bytes) / 1048576.0});
    row.push_back({"bricks_not_put_back", notPutBack(radius_voxel)});
    row.push_back({"seed", static_cast<std::int64_t>(seed)});
    result.rows.push_back(std::move(row));
    forget();
  }

  // The edit into the journal, as a session does it: what that takes of the engine's thread, and until the disk has
  // confirmed it, without the 3 ms in which a session's journal gathers records.
  double keep(std::span<const EditCommand> commands) {
    const Stopwatch appending;
    journal_->edit(commands);
    const double ms = 1e3 * appending.seconds();
    times_["journal"].push_back(ms);
    journal_->flush();
    times_["journal_saved"].push_back(1e3 * appending.seconds());
    return ms;
  }

  void recompute() { recompute_.run(); }

  // What was measured so far.
  void forget() {
    times_.clear();
    share_outside_.clear();
    bricks_.clear();
    recompute_.forget();
    edits_ = published_ = 0;
  }

 private:
  [[nodiscard]] Plan plan() const { return makePlan({.gradient_all = all_}); }
  [[nodiscard]] Vec3 centre_W() const { return Vec3(size_ / 2, size_ / 2, size_ / 2 + kPlane_voxel) * kSpacing_m; }
  [[nodiscard]] std::vector<BrickContent> contentOf(const std::vector<std::uint32_t>& bricks) const {
    std::vector<BrickContent> contents;
    for (const std::uint32_t brick : bricks) contents.push_back(engine_.content(brick));
    return contents;
  }

  void note(const Engine::EditResult& result, double whole_ms, double read_back_ms, double journal_ms, bool timed) {
    std::map<std::string, double> ms;
    for (const StageTime& stage : result.stages) ms[stage.name] += stage.seconds * 1e3;
    const double to_window_ms = whole_ms - ms["settle"];
    ++edits_;
    published_ += result.published ? 1 : 0;
    if (timed) {
      const double kernels_ms = ms["edit"] + ms["bounds"] + ms["gradient"] + ms["window"];
      for (const char* kernel : {"edit", "bounds", "gradient", "window"}) {
        if (ms.contains(kernel)) times_[std::string(kernel) + "_kernel"].push_back(ms[kernel]);
      }
      times_["submit_and_wait"].push_back(ms["gpu"] - kernels_ms);
      if (kernels_ms > 0) share_outside_.push_back(1 - kernels_ms / to_window_ms);
      return;
    }
    bricks_.push_back(static_cast<double>(result.changed_bricks));
    for (const char* stage : {"plan", "record", "publish", "settle"}) times_[stage].push_back(ms[stage]);
    times_["to_window"].push_back(to_window_ms);
    times_["read_back"].push_back(read_back_ms);
    times_["sum"].push_back(whole_ms + read_back_ms + journal_ms);
  }

  // Bricks within reach of the edits that do not hold what they did at first.
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
  Times times_;
  std::vector<double> share_outside_, bricks_;
  std::int64_t edits_ = 0, published_ = 0;
};

const BenchRow* editRow(const BenchResult& result, int size, const std::string& gradients, double radius) {
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") == "edit" && textOf(row, "gradients") == gradients &&
        figureOf(row, "volume_voxel") == size && figureOf(row, "radius_voxel") == radius) {
      return &row;
    }
  }
  return nullptr;
}

class EditBench {
 public:
  EditBench(const EditBenchRequest& request, Progress& progress) : request_(request), progress_(progress) {
    for (const int size : request.sizes) open(size, false);
    open(request.all_size, true);
    result_.bench = "edit";
    result_.machine = machineInWords();
    result_.vulkan_device = fmt::format("{}, {}", sessions_[0]->gpu().name, sessions_[0]->gpu().driver);
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
      // Anywhere in a brick's cell, up to a quarter radius deep or high: the same for every volume.
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
  const auto figure = [&](int size, const char* gradients, const char* key) {
    const BenchRow* row = editRow(result_, size, gradients, kTargetRadius_voxel);
    return row == nullptr ? std::nan("") : figureOf(*row, key);
  };
  const auto has = [&](int size) {
    return std::find(request_.sizes.begin(), request_.sizes.end(), size) != request_.sizes.end();
  };
  if (std::find(request_.radii.begin(), request_.radii.end(), kTargetRadius_voxel) == request_.radii.end()) {
    return result_.note("no targets: radius 8 was left out");
  }
  for (const int size : request_.sizes) {
    result_.targets.push_back({fmt::format("edit to published window, {}^3, radius 8 voxels, median [ms]", size),
                               figure(size, "needed", "to_window_median_ms"), 3});
  }
  if (has(64) && has(1024)) {
    const double ratio = figure(1024, "needed", "to_window_median_ms") / figure(64, "needed", "to_window_median_ms");
    result_.rows.push_back({{"part", "ratio"}, {"edit_1024_over_64", ratio}});
    result_.targets.push_back({"the same, 1024^3 / 64^3 [-]", ratio, 1.2});
  }
  const int size = request_.all_size;
  const double share = 1 / figure(size, "all", "recompute_over_edit");
  result_.targets.push_back({fmt::format("edit / full recompute, {}^3, --gradient all [-]", size), share, 1.0 / 50});
  double outside = figure(size, "all", "share_outside_kernels");
  for (const int one : request_.sizes) outside = std::max(outside, figure(one, "needed", "share_outside_kernels"));
  result_.targets.push_back({"share of an edit outside kernels, radius 8, worst volume [-]", outside, 0.5});
}

}  // namespace

EditBenchRequest EditBenchRequest::quick() {
  EditBenchRequest request;
  request.sizes = {64, 256, 1024};
  request.radii = {4, 8, 16};
  request.repetitions = 40;
  return request;
}

BenchResult runEditBench(const EditBenchRequest& request, Progress& progress) {
  return EditBench(request, progress).run();
}

}  // namespace palpate
