// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "apps/bench/field_bench.hpp"
#include "apps/bench/resident_chain.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_tasks.hpp"
#include "engine/passes/gradient_pass.hpp"

namespace palpate {
namespace {

// Planning and submitting take some 0.3 ms for any volume: a fifth of a run at 64^3, next to nothing at 256^3.
constexpr double kMostAt64 = 0.6;
constexpr const char* kActiveJob = "gradient central, needed bricks only";

// One operator on some bricks, with buffers allocated and kernels compiled.
class ResidentGradient {
 public:
  ResidentGradient(FieldBench& bench, const GradientOperator& gradient_operator,
                   const std::vector<std::uint32_t>& bricks, const SampleFormat& format)
      : pool_(bench.pool()),
        steps_(lowerFilters(gradient_operator.smoothing, pool_.lattice().spacing_m)),
        store_(bench.gpu(), pool_.brickCount(), bricks, pool_.budget(), format) {
    if (!steps_.empty()) smoothing_.emplace(bench.gpu(), bench.transfer(), pool_, steps_);
    pass_.emplace(bench.gpu(), bench.transfer(), pool_, store_, gradient_operator,
                  smoothing_ ? &smoothing_->result() : nullptr);
    BrickTasks by_slab;
    for (const std::uint32_t brick : store_.bricks()) by_slab.add(brick, store_.place(brick));
    std::vector<layout::BrickTask> list;
    ranges_ = by_slab.moveTo(list);
    tasks_.emplace(bench.gpu(), "gradient tasks", std::max<std::size_t>(1, list.size()) * sizeof(layout::BrickTask),
                   gpu::MemoryKind::kDevice);
    bench.transfer().upload(std::as_bytes(std::span(list)), *tasks_);
    const std::uint32_t smoothing = smoothing_ ? smoothing_->dispatches() : 0;
    commands_.emplace(bench.gpu(), "gradient", std::max(1U, smoothing + static_cast<std::uint32_t>(ranges_.size())));
  }

  RunCost run() {
    return costOf([&] {
      if (smoothing_) smoothing_->plan();
      commands_->begin();
      if (smoothing_) smoothing_->record(*commands_);
      pass_->record(*commands_, *tasks_, ranges_, {});
      commands_->run();
      if (smoothing_) smoothing_->settle();
    });
  }

  // Bytes of densities read and samples written. An operator that smooths also reads the original densities, which its
  // samples hold.
  [[nodiscard]] double movedBytes() const {
    const std::size_t fields = smoothing_ ? 2 : 1;
    const double gradient = static_cast<double>(store_.brickCount()) * kBrickVoxels *
                            static_cast<double>(fields * sizeof(float) + store_.format().bytesAVoxel());
    return gradient + (smoothing_ ? smoothing_->movedBytes() : 0);
  }

 private:
  const BrickPool& pool_;
  std::vector<FilterStep> steps_;
  SampleStore store_;
  std::optional<ResidentChain> smoothing_;
  std::optional<GradientPass> pass_;
  std::vector<TaskRange> ranges_;
  std::optional<gpu::Buffer> tasks_;
  std::optional<gpu::Commands> commands_;
};

SampleFormat halves(const Volume& volume) {
  const auto isovalue = static_cast<float>(volume.facts().declared_isovalue.value_or(0));
  return halfSamples(isovalue, volume.minimum(), volume.maximum(), volume.lattice().spacing_m);
}

void measureOperator(FieldBench& bench, const GradientKind& kind) {
  const std::string name = kind.parameter.empty() ? std::string(kind.name) : fmt::format("{}:1.5", kind.name);
  const GradientOperator gradient_operator = gradientOperator(name);
  const std::vector<std::uint32_t> bricks = allBricks(bench.pool().grid());
  ResidentGradient floats(bench, gradient_operator, bricks, {}),
      half(bench, gradient_operator, bricks, halves(bench.volume()));
  bench.measure("gradient " + name, "gradient " + name,
                {{"samples as floats", floats.movedBytes(), [&] { return floats.run(); }},
                 {"samples as halves", half.movedBytes(), [&] { return half.run(); }}});
}

void measureHead(FieldBench& bench, const std::string& name, Progress& progress) {
  progress.stage("loading " + name);
  const std::string file = name.starts_with("phantom:") ? name : std::filesystem::path(name).filename().string();
  if (!bench.tryOpen(file, [&] { return loadVolume(name); })) return;
  const double isovalue = defaultIsovalue(bench.volume());
  BrickBoundsPass bounds(bench.gpu(), bench.pool());
  bounds.run();
  const std::vector<std::uint32_t> needed =
      activeBricks(bounds.read(bench.transfer()), bench.pool().grid(), static_cast<float>(isovalue));
  ResidentGradient gradient(bench, {}, needed, {});
  const auto withBounds = [&] {
    const RunCost first = costOf([&] { bounds.run(); });
    const RunCost second = gradient.run();
    return RunCost{first.wall_ms + second.wall_ms, first.cpu_ms + second.cpu_ms};
  };
  const auto bounds_bytes = static_cast<double>(bench.pool().storedBricks() * kBrickVoxels * sizeof(float));
  bench.result().note(
      fmt::format("{}: {} x {} x {} voxels, isovalue {:g}, which needs {} of {} bricks; the rivals compute all voxels",
                  file, bench.volume().size().x(), bench.volume().size().y(), bench.volume().size().z(), isovalue,
                  needed.size(), bench.pool().brickCount()));
  bench.measure(kActiveJob, "gradient central",
                {{"bounds of all bricks, then the needed ones", bounds_bytes + gradient.movedBytes(), withBounds},
                 {"the needed bricks", gradient.movedBytes(), [&] { return gradient.run(); }}});
  bench.promise(kActiveJob, file, "VTK", 1);
}

}  // namespace

std::string headVolume() {
  std::vector<std::filesystem::path> places;
  if (const char* cache = std::getenv("XDG_CACHE_HOME")) {
    places.push_back(std::filesystem::path(cache) / "palpate/Cranium.inv3");
  } else if (const char* home = std::getenv("HOME")) {
    places.push_back(std::filesystem::path(home) / ".cache/palpate/Cranium.inv3");  // where ./dev demo keeps it
  }
  if (const char* data = std::getenv("PALPATE_DATA")) {
    places.push_back(std::filesystem::path(data) / "ct_head_invesalius.nrrd");
  }
  std::error_code ignored;
  for (const auto& place : places) {
    if (std::filesystem::is_regular_file(place, ignored)) return place.string();
  }
  return "phantom:head?size=256";
}

BenchResult runGradientBench(const FieldBenchRequest& request, Progress& progress) {
  constexpr int kLeastForHead_voxel = 64;
  FieldBench bench("gradient", request, progress);
  bool large = false;
  for (const int size : request.sizes) {
    large = large || size >= kLeastForHead_voxel;
    if (!bench.tryOpenNoisy(size)) continue;
    for (const GradientKind& kind : gradientKinds()) {
      bench.attempt("gradient " + std::string(kind.name), [&] { measureOperator(bench, kind); });
    }
  }
  bench.promise({{"gradient central", "ITK", 256, 0.45}, {"gradient central", "ITK", 64, kMostAt64}},
                "no target of a whole volume");
  if (large) bench.attempt(kActiveJob, [&] { measureHead(bench, headVolume(), progress); });
  return std::move(bench.result());
}

}  // namespace palpate
