// SPDX-License-Identifier: Apache-2.0
// The study of gradients: operator x storage x voxel size, and other libraries, against the time for a voxel.
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/bench/resident_gradient.hpp"
#include "apps/bench/touch_errors.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/field_rivals.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/studies.hpp"
#include "apps/study/study_gpu.hpp"
#include "apps/study/wave_field.hpp"
#include "base/quantile.hpp"
#include "base/units.hpp"
#include "engine/bricks/active_bricks.hpp"

namespace palpate {
namespace {

constexpr double kWaveNoise = 0.02;  // as a share of the field's own deviation

struct GradientWay {
  std::string library, gradient_operator, storage;
};

// The same list wherever it is made: a library that is not installed is in it too.
std::vector<GradientWay> gradientWays() {
  std::vector<GradientWay> ways;
  for (const char* name : {"central", "sobel", "central4", "gaussian:1", "gaussian:1.5"}) {
    for (const char* storage : {"float", "half"}) ways.push_back({kOwnLibrary, name, storage});
  }
  for (const char* library : {"ITK", "VTK", "OpenVDB", "SciPy"}) ways.push_back({library, "central", "float"});
  ways.push_back({"SciPy", "sobel", "float"});
  ways.push_back({"SciPy", "gaussian:1.5", "float"});
  return ways;
}

// The waves as a volume, and the places at which gradients are compared.
struct WaveVolume {
  WaveVolume(const WaveField& waves, int edge, double noise, std::size_t places, std::uint64_t seed)
      : volume(waves.volume(edge, noise, seed)), dense(volume.toDense()) {
    // Nearest to the same places at every size. Behind a border of a sixth of the edge, where operators are one-sided
    // and a Gaussian is cut off; and not where the gradient is so small that its direction means nothing.
    constexpr double kFirst = 1.0 / 6, kLast = 5.0 / 6;
    const double least_per_m = 0.3 * waves.usualGradient_per_m();
    Random random(seed);
    while (voxels.size() < places) {
      Vec3 place;
      for (double& along : place) along = random.uniform(kFirst, kLast);
      if (waves.gradient(WaveField::kEdge_m * place).norm() < least_per_m) continue;
      voxels.push_back((edge * place).array().round().matrix().cast<int>());
      exact_per_m.push_back(waves.gradient(volume.lattice().toWorld(voxels.back().cast<double>())));
    }
  }
  [[nodiscard]] RivalField field() const { return {volume.size(), volume.lattice().spacing_m, dense}; }
  [[nodiscard]] double voxelCount() const { return static_cast<double>(dense.size()); }

  Volume volume;
  std::vector<float> dense;
  std::vector<Vec3i> voxels;
  std::vector<Vec3> exact_per_m;
};

// Gradients against the exact ones at the same places.
BenchRow gradientErrors(std::span<const Vec3> found_per_m, std::span<const Vec3> exact_per_m) {
  std::vector<double> angle_deg, length_percent;
  for (std::size_t i = 0; i < found_per_m.size(); ++i) {
    const Vec3 &found = found_per_m[i], &exact = exact_per_m[i];
    angle_deg.push_back(angleBetween_deg(found, exact));
    length_percent.push_back(100 * std::abs(found.norm() / exact.norm() - 1));
  }
  const Percentiles angle = percentiles(std::move(angle_deg)), length = percentiles(std::move(length_percent));
  return {{"angle_median_deg", angle.p50},
          {"angle_p99_deg", angle.p99},
          {"length_median_percent", length.p50},
          {"length_p99_percent", length.p99}};
}

class GradientStage {
 public:
  explicit GradientStage(const StudySettings& settings)
      : settings_(settings), waves_(settings.seed), rivals_(settings.python) {}

  CellFigures run(const GradientWay& way, int edge, double noise) {
    const WaveVolume& on = waveOf(edge, noise);
    std::vector<Vec3> found_per_m;
    const RunCost cost =
        way.library == kOwnLibrary ? own(way, {edge, noise}, on, found_per_m) : rival(way, on, found_per_m);
    const double ns = 1e6 / on.voxelCount();
    return {gradientErrors(found_per_m, on.exact_per_m),
            {{"wall_ns_a_voxel", ns * cost.wall_ms}, {"cpu_ns_a_voxel", ns * cost.cpu_ms}}};
  }

 private:
  using Which = std::pair<int, double>;  // voxels along an edge, noise

  const WaveVolume& waveOf(int edge, double noise) {
    const std::size_t places = settings_.quick ? 5000 : 20000;
    return volumes_.of({edge, noise},
                       [&] { return std::make_unique<WaveVolume>(waves_, edge, noise, places, settings_.seed); });
  }

  RunCost own(const GradientWay& way, const Which& which, const WaveVolume& on, std::vector<Vec3>& found_per_m) {
    StudyGpu& device = gpu_.of(settings_.gpu);
    const BrickPool& pool =
        pools_.of(which, [&] { return std::make_unique<BrickPool>(device.gpu, device.transfer, on.volume); });
    ResidentGradient& gradient = gradients_.of({which, way.gradient_operator + way.storage}, [&] {
      const SampleFormat format = way.storage == "half" ? halvesFor(on.volume) : SampleFormat{};
      return std::make_unique<ResidentGradient>(
          device.gpu, device.transfer, pool, gradientOperator(way.gradient_operator), allBricks(pool.grid()), format);
    });
    const RunCost cost = gradient.run();
    for (const Sample& sample : gradient.at(on.voxels)) {
      found_per_m.emplace_back(sample.gradient_i, sample.gradient_j, sample.gradient_k);
    }
    return cost;
  }

  RunCost rival(const GradientWay& way, const WaveVolume& on, std::vector<Vec3>& found_per_m) {
    std::vector<float> result;  // per mm, as the libraries have it
    std::string called;
    const RunCost cost = rivals_.run(way.library, "gradient " + way.gradient_operator, on.field(), called, &result);
    for (const Vec3i& voxel : on.voxels) {
      const Vec3i& size = on.volume.size();
      const std::size_t at = 3 * ((static_cast<std::size_t>(voxel.z()) * size.y() + voxel.y()) * size.x() + voxel.x());
      found_per_m.push_back(Vec3(result.at(at), result.at(at + 1), result.at(at + 2)) / kMetresPerMillimetre);
    }
    return cost;
  }

  StudySettings settings_;
  WaveField waves_;
  FieldRivals rivals_;
  LazyGpu gpu_;
  Shared<Which, WaveVolume> volumes_;
  Shared<Which, BrickPool> pools_;
  Shared<std::pair<Which, std::string>, ResidentGradient> gradients_;
};

std::vector<int> waveEdges(bool quick) {
  return quick ? std::vector{48, 64, 96} : std::vector{48, 64, 96, 128, 192};
}
int plottedEdge(bool quick) {
  return quick ? 96 : 128;
}

std::vector<StudyCell> gradientCells(const StudySettings& settings) {
  const auto stage = std::make_shared<GradientStage>(settings);
  std::vector<StudyCell> cells;
  for (const double noise : {0.0, kWaveNoise}) {
    for (const int edge : waveEdges(settings.quick)) {
      if (noise > 0 && edge != plottedEdge(settings.quick)) continue;
      for (const GradientWay& way : gradientWays()) {
        cells.push_back({{{"library", way.library},
                          {"operator", way.gradient_operator},
                          {"storage", way.storage},
                          {"edge_voxels", std::int64_t{edge}},
                          {"voxel_mm", 1e3 * WaveField::spacing_m(edge)},
                          {"noise", noise}},
                         [=] { return stage->run(way, edge, noise); }});
      }
    }
  }
  return cells;
}

std::vector<StudyPlot> gradientPlots(bool quick) {
  const auto plot = [&](const char* title, double noise, const char* y, const char* y_label) {
    return StudyPlot{
        .title = title,
        .like = {{"edge_voxels", std::int64_t{plottedEdge(quick)}}, {"noise", noise}},
        .x = "wall_ns_a_voxel",
        .x_label = "time for a voxel [ns]",
        .y = y,
        .y_label = y_label,
        .series = {"library", "operator"},
        .labels = {"storage"},
        .standard = {{"library", kOwnLibrary}, {"operator", Scene{}.gradient_operator}, {"storage", Scene{}.samples}},
        .own = "library"};
  };
  StudyPlot sizes = plot("voxel size", 0.0, "angle_median_deg", "angle, median [degree]");
  sizes.like = {{"noise", 0.0}, {"storage", "float"}};
  sizes.x = "voxel_mm";
  sizes.x_label = "voxel [mm]; the shortest wave has 25 mm";
  sizes.labels = {};
  sizes.front = false;
  sizes.standard = {};
  return {plot("angle", 0.0, "angle_median_deg", "angle, median [degree]"),
          plot("length", 0.0, "length_median_percent", "length, median [%]"),
          plot("angle, noise", kWaveNoise, "angle_median_deg", "angle, median [degree]"), std::move(sizes)};
}

// A fit for each operator, over the sizes at which its leading term rules. Taylor's next term of a Gaussian is half of
// (k sigma h)^2 of the first, so the shortest wave needs 25 voxels. The error of central4 comes near to what rounding
// densities to float makes of gradients where a wave has 50 voxels.
std::vector<StudyOrder> gradientOrders(bool /*quick*/) {
  const auto order = [](const char* gradient_operator, double least_mm, double most_mm) {
    return StudyOrder{.what = fmt::format("angle of {} against the size of a voxel", gradient_operator),
                      .like = {{"operator", gradient_operator}, {"storage", "float"}, {"noise", 0.0}},
                      .family = {"library", "operator"},
                      .x = "voxel_mm",
                      .y = "angle_median_deg",
                      .least = least_mm,
                      .most = most_mm,
                      .theory = [](const BenchRow& row) { return textOf(row, "operator") == "central4" ? 4.0 : 2.0; }};
  };
  constexpr double kAny = 10;
  return {order("central", 0, kAny), order("sobel", 0, kAny), order("central4", 0.6, kAny), order("gaussian:1", 0, 1),
          order("gaussian:1.5", 0, 1)};
}

constexpr const char* kGradientWords = R"(
A sum of six plane waves, whose gradient is known everywhere, in a cube of 64 mm; the shortest wave has 25 mm.
Every operator runs over the whole volume, which lies in the brick pool with room for results at hand; the others' as their own
images and grids, with a result made anew for each run, as they make it.
Angle and length of the gradient against the exact ones, at random voxels behind the border where the gradient is not small.
Noise has a deviation of 2 % of the field's own.
Halves store samples in 8 bytes instead of 16, with 11 significant bits.)";

}  // namespace

Study gradientStudy() {
  return {.name = "gradients",
          .title = "Gradients: error against the time for a voxel",
          .words = asParagraph(kGradientWords),
          .on_gpu = true,
          .rounds = 7,
          .seconds = 150,
          .quick_seconds = 20,
          .cells = gradientCells,
          .plots = gradientPlots,
          .orders = gradientOrders};
}

}  // namespace palpate
