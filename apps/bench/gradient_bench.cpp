// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "apps/bench/field_bench.hpp"
#include "apps/bench/head_volume.hpp"
#include "apps/bench/resident_gradient.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/passes/brick_bounds_pass.hpp"

namespace palpate {
namespace {

// Planning and submitting take some 0.3 ms for any volume: a fifth of a run at 64^3, next to nothing at 256^3.
constexpr double kMostAt64 = 0.6;
constexpr const char* kActiveJob = "gradient central, needed bricks only";

void measureOperator(FieldBench& bench, const GradientKind& kind) {
  const std::string name = kind.parameter.empty() ? std::string(kind.name) : fmt::format("{}:1.5", kind.name);
  const GradientOperator gradient_operator = gradientOperator(name);
  const std::vector<std::uint32_t> bricks = allBricks(bench.pool().grid());
  ResidentGradient floats(bench.gpu(), bench.transfer(), bench.pool(), gradient_operator, bricks, {}),
      half(bench.gpu(), bench.transfer(), bench.pool(), gradient_operator, bricks, halvesFor(bench.volume()));
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
  ResidentGradient gradient(bench.gpu(), bench.transfer(), bench.pool(), {}, needed, {});
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
