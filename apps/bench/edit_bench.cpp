// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/edit_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/bench/scratch_folder.hpp"
#include "apps/console/interrupt.hpp"
#include "base/stopwatch.hpp"
#include "engine/journal/journal_writer.hpp"
#include "engine/passes/active_bricks.hpp"
#include "engine/passes/gpu_budget.hpp"
#include "engine/service/engine.hpp"
#include "servo/loop/quantile.hpp"

namespace palpate {
namespace {

constexpr const char* kWork = "palpate bench edit";
constexpr double kIsovalue = 0.5;
constexpr double kSpacing_m = 1e-3;
constexpr double kPlane_voxel = 3.5;  // above the middle: in the middle of a layer of bricks
constexpr double kRamp_voxel = 4;
constexpr double kTargetRadius_voxel = 8;
constexpr std::size_t kTurn = 8;  // edits of one volume before the next has its turn, as a stroke's follow one another

double median(std::vector<double> values) {
  return percentiles(std::move(values)).p50;
}

bool flatBrick(int size, const Vec3i& brick, float* values) {
  const double surface = size / 2 + kPlane_voxel;
  const auto at = [&](int k) {
    return static_cast<float>(std::clamp(0.5 + (surface - brick.z() * kBrickSize - k) / kRamp_voxel, 0.0, 1.0));
  };
  values[0] = at(0);
  if (at(0) == at(kBrickSize - 1)) return true;
  for (int n = 0; n < kBrickVoxels; ++n) values[n] = at(n / (kBrickSize * kBrickSize));
  return false;
}

// Milliseconds of every edit, by stage.
using Times = std::map<std::string, std::vector<double>>;

// One volume under edits.
class Session {
 public:
  Session(int size, bool all_gradients, const std::string& gpu)
      : size_(size), all_(all_gradients), volume_(flatVolume(size)), engine_(volume_, plan(), kIsovalue, gpu) {
    const std::vector<EditKind> kinds = {EditKind::kRemove, EditKind::kAdd};
    engine_.allowEdits(brushProfile(kIsovalue, 0, 1, Vec3::Constant(kSpacing_m)), kinds);
    static_cast<void>(engine_.publishAround(centre_W(), 1));
    const VolumeIdentity identity{volume_.facts().source, volume_.size(), volume_.lattice(), 0};
    journal_.emplace(folder_.path(), JournalHeader{identity, engine_.editor().profile()});
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
    const std::vector<BrickContent> before = contentOf(engine_.editor().bricksToChange(commands));
    engine_.timeKernels(time_kernels);
    const Stopwatch watch;
    const Engine::EditResult result = engine_.edit(commands, 2);
    const double whole_ms = 1e3 * watch.seconds();
    const Stopwatch reading;
    static_cast<void>(engine_.readBack(volume_));
    note(result, whole_ms, 1e3 * reading.seconds(), time_kernels);
    keep(commands);
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
    row.push_back({"share_outside_kernels", median(share_outside_)});
    row.push_back({"gpu_memory_MiB", static_cast<double>(engine_.memory().back().bytes) / 1048576.0});
    row.push_back({"bricks_not_put_back", notPutBack(radius_voxel)});
    row.push_back({"seed", static_cast<std::int64_t>(seed)});
    result.rows.push_back(std::move(row));
    forget();
  }

  // The edit into the journal, as a session does it: what that takes of the engine's thread, and until the disk has
  // confirmed it, without the 3 ms in which a session's journal gathers records.
  void keep(std::span<const EditCommand> commands) {
    const Stopwatch appending;
    journal_->edit(commands);
    times_["journal"].push_back(1e3 * appending.seconds());
    journal_->flush();
    times_["journal_saved"].push_back(1e3 * appending.seconds());
  }

  // What was measured so far.
  void forget() {
    times_.clear();
    share_outside_.clear();
    bricks_.clear();
    edits_ = published_ = 0;
  }

 private:
  [[nodiscard]] Plan plan() const {
    Scene scene;
    scene.picture = false;
    scene.gradient_all = all_;
    return makePlan(scene);
  }
  [[nodiscard]] Vec3 centre_W() const { return Vec3(size_ / 2, size_ / 2, size_ / 2 + kPlane_voxel) * kSpacing_m; }
  [[nodiscard]] std::vector<BrickContent> contentOf(const std::vector<std::uint32_t>& bricks) const {
    std::vector<BrickContent> contents;
    for (const std::uint32_t brick : bricks) contents.push_back(engine_.editor().content(brick));
    return contents;
  }

  void note(const Engine::EditResult& result, double whole_ms, double read_back_ms, bool timed) {
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
    times_["sum"].push_back(whole_ms + read_back_ms);
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
          const bool was_constant = flatBrick(size_, {x, y, z}, then.data());
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
  ScratchFolder folder_;
  std::optional<JournalWriter> journal_;  // in that folder
  Times times_;
  std::vector<double> share_outside_, bricks_;
  std::int64_t edits_ = 0, published_ = 0;
};

// Bounds, gradients of every brick, and a window, of a volume that is on the device already.
class Recompute {
 public:
  Recompute(int size, const std::string& name)
      : gpu_(gpu::GpuRequest{.name = name}),
        transfer_(gpu_),
        pool_(gpu_, transfer_, flatVolume(size), makeGpuBudget()),
        bounds_(gpu_, pool_),
        store_(gpu_, pool_.brickCount(), allBricks(pool_.brickCounts()), pool_.budget()),
        gradient_(gpu_, transfer_, pool_, store_),
        window_(gpu_, pool_, store_),
        box_(windowAround(Vec3::Constant(size / 2), pool_.size())),
        buffer_(gpu_, "window", static_cast<std::size_t>(box_.size.prod()) * sizeof(Sample), gpu::MemoryKind::kHost) {}

  void run(bool warm_up = false) {
    const Stopwatch watch;
    bounds_.run();
    gradient_.run();
    window_.run(box_, buffer_);
    if (!warm_up) times_ms_.push_back(1e3 * watch.seconds());
  }
  [[nodiscard]] const std::vector<double>& times_ms() const { return times_ms_; }

 private:
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  BrickBoundsPass bounds_;
  SampleStore store_;
  GradientPass gradient_;
  WindowPass window_;
  WindowBox box_;
  gpu::Buffer buffer_;
  std::vector<double> times_ms_;
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
    open(request.recompute_size, true);
    progress_.stage("computing a whole volume");
    recompute_ = std::make_unique<Recompute>(request.recompute_size, request.gpu);
    recompute_->run(true);
    result_.bench = "edit";
    result_.machine = machineInWords();
    result_.vulkan_device = fmt::format("{}, {}", sessions_[0]->gpu().name, sessions_[0]->gpu().driver);
  }

  BenchResult run() {
    for (const double radius : request_.radii) atRadius(radius);
    addRecompute();
    addTargets();
    return std::move(result_);
  }

 private:
  void open(int size, bool all) {
    throwIfInterrupted(kWork);
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
      throwIfInterrupted(kWork);
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
      if (radius == kTargetRadius_voxel && turns++ % 2 == 0) recompute_->run();
    }
    for (const auto& session : sessions_) session->addRow(result_, radius, request_.seed);
  }

  void addRecompute() {
    if (recompute_->times_ms().empty()) return;
    const Percentiles p = percentiles(recompute_->times_ms());
    result_.rows.push_back({{"part", "recompute"},
                            {"volume_voxel", std::int64_t{request_.recompute_size}},
                            {"gradients", "all"},
                            {"recomputes", static_cast<std::int64_t>(recompute_->times_ms().size())},
                            {"recompute_median_ms", p.p50},
                            {"recompute_p99_ms", p.p99}});
  }

  void addTargets();

  EditBenchRequest request_;
  Progress& progress_;
  std::vector<std::unique_ptr<Session>> sessions_;
  std::unique_ptr<Recompute> recompute_;
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
  const int size = request_.recompute_size;
  const double share = figure(size, "all", "to_window_median_ms") / median(recompute_->times_ms());
  result_.rows.push_back({{"part", "ratio"}, {"recompute_over_edit", 1 / share}});
  result_.targets.push_back({fmt::format("edit / full recompute, {}^3, --gradient all [-]", size), share, 1.0 / 50});
  double outside = 0;
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

Volume flatVolume(int size) {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(kSpacing_m);
  VolumeFacts facts;
  facts.source = fmt::format("a plane in {0} x {0} x {0} voxels", size);
  return Volume::fromBricks(Vec3i::Constant(size), lattice, std::move(facts),
                            [size](const Vec3i& brick, float* values) { return flatBrick(size, brick, values); });
}

BenchResult runEditBench(const EditBenchRequest& request, Progress& progress) {
  return EditBench(request, progress).run();
}

}  // namespace palpate
