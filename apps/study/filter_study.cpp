// SPDX-License-Identifier: Apache-2.0
// The study of filters: how much noise each removes and how far it moves the surface, against its time.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/bench/resident_chain.hpp"
#include "apps/study/field_rivals.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/studies.hpp"
#include "apps/study/study_gpu.hpp"
#include "apps/study/surface_offsets.hpp"
#include "engine/passes/pool_volume.hpp"

namespace palpate {
namespace {

constexpr double kScanNoise = 0.05;  // deviation as a share of the contrast; it moves the surface by 0.3 voxel
constexpr const char* kKnot = "knot";
constexpr const char* kBall = "ball";
constexpr double kBallRadius_voxel = 30;
constexpr int kBallEdge = 96;

struct FilterWay {
  std::string library, filter;
  double sigma_voxel = 0;  // of a Gaussian
};

FilterWay gaussianWay(const std::string& library, double sigma_voxel) {
  return {library, fmt::format("gaussian:{:g}", sigma_voxel), sigma_voxel};
}

std::vector<FilterWay> knotWays() {
  std::vector<FilterWay> ways = {{kOwnLibrary, "none"}};
  for (const double sigma : {0.5, 0.7, 1.0, 1.5, 2.0, 3.0}) ways.push_back(gaussianWay(kOwnLibrary, sigma));
  for (const char* filter : {"median:1", "median:2", "bilateral:1:range=200", "bilateral:1.5:range=400",
                             "diffuse:5:kappa=200", "diffuse:15:kappa=200", "diffuse:5:kappa=400"}) {
    ways.push_back({kOwnLibrary, filter});
  }
  for (const char* library : {"ITK", "VTK", "SciPy", "OpenVDB"}) {
    ways.push_back(gaussianWay(library, 1.5));
    ways.push_back({library, "median:1"});
  }
  ways.push_back({"ITK", "bilateral:1:range=200"});
  ways.push_back({"ITK", "diffuse:5:kappa=200"});
  ways.push_back({"VTK", "diffuse:5:kappa=200"});
  return ways;
}

std::vector<FilterWay> ballWays() {
  std::vector<FilterWay> ways;
  for (const double sigma : {1.0, 1.5, 2.0, 3.0, 4.0}) ways.push_back(gaussianWay(kOwnLibrary, sigma));
  return ways;
}

// A volume to be filtered, and where its exact surface is.
struct NoisyVolume {
  Volume volume;
  float isovalue = 0;
  double contrast = 1;                     // of the object over the background [density]
  std::vector<ExactSurfacePoint> surface;  // exact
  std::vector<Vec3i> flat;                 // voxels where the exact density is `flat_density` all around
  double flat_density = 0;
  std::vector<float> dense = volume.toDense();
  double sampled_mean_m =
      0;  // of the surface's offsets before any filter: trilinear interpolation puts a ball's inward
  [[nodiscard]] RivalField field() const { return {volume.size(), volume.lattice().spacing_m, dense}; }
};

NoisyVolume knotVolume(const StudySettings& settings) {
  const int edge = settings.quick ? 64 : 128;
  constexpr double kBorder_voxel = 8, kFlat_voxel = 14;  // libraries differ in what they read beyond the border
  const std::string name =
      fmt::format("phantom:knot?size={}&spacing=1mm&noise={}&seed={}", edge, kScanNoise, settings.seed);
  const auto phantom = makePhantom(name);
  NoisyVolume made{.volume = makeVolume(*phantom),
                   .isovalue = static_cast<float>(phantom->isovalue()),
                   .contrast = phantom->profile().high - phantom->profile().low,
                   .surface = exactSurfacePoints(*phantom, settings.quick ? 1000 : 4000, kBorder_voxel, settings.seed),
                   .flat = {},
                   .flat_density = phantom->profile().low};
  // Far outside: no filter of the study reaches from there to the surface's ramp.
  Random random(settings.seed);
  while (made.flat.size() < 10000) {
    Vec3i voxel;
    for (int& index : voxel) index = static_cast<int>(random.uniform(kBorder_voxel, edge - kBorder_voxel));
    const double distance_m = phantom->signedDistance_m(phantom->lattice().toWorld(voxel.cast<double>()));
    if (distance_m > kFlat_voxel * phantom->lattice().smallestSpacing()) made.flat.push_back(voxel);
  }
  return made;
}

// Density falls linearly with the distance from the middle, without end: a Gaussian moves its surface inward by
// sigma^2 / R, and by no more, since the distance has no further derivatives of Laplace.
NoisyVolume ballVolume(const StudySettings& settings) {
  constexpr double kVoxel_m = 1e-3, kSlope = 100;  // [density / voxel]
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(kVoxel_m);
  lattice.origin_W = Vec3::Constant(-0.5 * (kBallEdge - 1) * kVoxel_m);
  std::vector<float> values;
  for (int k = 0; k < kBallEdge; ++k) {
    for (int j = 0; j < kBallEdge; ++j) {
      for (int i = 0; i < kBallEdge; ++i) {
        const double radius_voxel = lattice.toWorld(Vec3(i, j, k)).norm() / kVoxel_m;
        values.push_back(static_cast<float>(kSlope * (kBallRadius_voxel - radius_voxel)));
      }
    }
  }
  NoisyVolume made{
      .volume = Volume::fromDense(Vec3i::Constant(kBallEdge), lattice, values, {}), .surface = {}, .flat = {}};
  Random random(settings.seed);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 normal_W = random.direction();
    made.surface.push_back({kBallRadius_voxel * kVoxel_m * normal_W, normal_W});
  }
  return made;
}

// Deviation from the exact density, as a share of the contrast.
double noiseIn(const reference::DenseField& field, const NoisyVolume& of) {
  if (of.flat.empty()) return std::nan("");
  double squares = 0;
  for (const Vec3i& voxel : of.flat) {
    const double off = field.at(voxel.x(), voxel.y(), voxel.z()) - of.flat_density;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(of.flat.size())) / of.contrast;
}

class FilterStage {
 public:
  explicit FilterStage(const StudySettings& settings) : settings_(settings), rivals_(settings.python) {}

  CellFigures run(const FilterWay& way, const std::string& volume) {
    const NoisyVolume& on = volumes_.of(volume, [&] {
      auto made = std::make_unique<NoisyVolume>(volume == kKnot ? knotVolume(settings_) : ballVolume(settings_));
      const reference::DenseField field{made->volume.size(), made->volume.lattice(), made->dense};
      made->sampled_mean_m = surfaceOffsets(field, made->isovalue, made->surface).mean_m;
      return made;
    });
    reference::DenseField result{on.volume.size(), on.volume.lattice(), {}};
    std::string called = way.filter;
    CellFigures figures;
    if (way.filter == "none") {
      result.values = on.dense;
    } else {
      const RunCost cost = way.library == kOwnLibrary
                               ? own(way, volume, on, result.values)
                               : rivals_.run(way.library, way.filter, on.field(), called, &result.values);
      figures.costs = {{"wall_ms", cost.wall_ms}, {"cpu_ms", cost.cpu_ms}};
    }
    const SurfaceOffsets offsets = surfaceOffsets(result, on.isovalue, on.surface);
    const double voxel_m = on.volume.lattice().smallestSpacing();
    figures.errors = {{"way", called},
                      {"noise_left_percent", 100 * noiseIn(result, on) / kScanNoise},
                      {"surface_off_rms_voxel", offsets.rms_m / voxel_m},
                      {"surface_off_mean_voxel", offsets.mean_m / voxel_m},
                      {"surface_moved_voxel", std::abs(offsets.mean_m - on.sampled_mean_m) / voxel_m},
                      {"surface_lost", static_cast<std::int64_t>(offsets.lost)}};
    return figures;
  }

 private:
  RunCost own(const FilterWay& way, const std::string& volume, const NoisyVolume& on, std::vector<float>& result) {
    StudyGpu& device = gpu_.of(settings_.gpu);
    const BrickPool& pool =
        pools_.of(volume, [&] { return std::make_unique<BrickPool>(device.gpu, device.transfer, on.volume); });
    ResidentChain& chain = chains_.of({volume, way.filter}, [&] {
      return std::make_unique<ResidentChain>(
          device.gpu, device.transfer, pool,
          lowerFilters(filterChain(way.filter), on.volume.lattice().spacing_m, on.isovalue));
    });
    const RunCost cost = chain.run();
    result = densitiesOf(chain.result(), device.transfer);
    return cost;
  }

  StudySettings settings_;
  FieldRivals rivals_;
  LazyGpu gpu_;
  Shared<std::string, NoisyVolume> volumes_;
  Shared<std::string, BrickPool> pools_;
  Shared<std::pair<std::string, std::string>, ResidentChain> chains_;
};

std::vector<StudyCell> filterCells(const StudySettings& settings) {
  const auto stage = std::make_shared<FilterStage>(settings);
  std::vector<StudyCell> cells;
  const auto add = [&](const std::string& volume, const std::vector<FilterWay>& ways) {
    for (const FilterWay& way : ways) {
      cells.push_back({{{"volume", volume},
                        {"library", way.library},
                        {"filter", way.filter},
                        {"kind", way.filter.substr(0, way.filter.find(':'))},
                        {"sigma_voxel", way.sigma_voxel}},
                       [=] { return stage->run(way, volume); }});
    }
  };
  add(kKnot, knotWays());
  add(kBall, ballWays());
  return cells;
}

std::vector<StudyPlot> filterPlots(bool /*quick*/) {
  const auto plot = [](const char* title, const char* y, const char* y_label) {
    return StudyPlot{.title = title,
                     .like = {{"volume", kKnot}},
                     .x = "wall_ms",
                     .x_label = "time [ms]",
                     .y = y,
                     .y_label = y_label,
                     .series = {"library", "kind"},
                     .labels = {"filter"},
                     .own = "library"};
  };
  StudyPlot both = plot("surface against noise", "surface_off_rms_voxel", "surface off, root mean square [voxel]");
  both.x = "noise_left_percent";
  both.x_label = "noise left far from the surface [%]";
  both.standard = {{"filter", "none"}};
  StudyPlot sigmas = plot("sigma", "surface_moved_voxel", "surface moved, mean [voxel]");
  sigmas.like = {{"volume", kBall}};
  sigmas.x = "sigma_voxel";
  sigmas.x_label = "sigma [voxel], a ball of 30 voxels";
  sigmas.front = false;
  sigmas.labels = {};
  sigmas.lines = {{"sigma^2 / R", [](double sigma) { return sigma * sigma / kBallRadius_voxel; }}};
  return {plot("noise", "noise_left_percent", "noise left far from the surface [%]"),
          plot("surface", "surface_off_rms_voxel", "surface off, root mean square [voxel]"), std::move(both),
          std::move(sigmas)};
}

std::vector<StudyOrder> filterOrders(bool /*quick*/) {
  return {{.what = "how far a Gaussian moves the surface of a ball, against sigma",
           .like = {{"volume", kBall}},
           .family = {"library", "kind"},
           .x = "sigma_voxel",
           .y = "surface_moved_voxel",
           .theory = [](const BenchRow&) { return 2.0; }}};
}

constexpr const char* kFilterWords = R"(
The knot phantom with noise of 5 % of its contrast, which moves its surface by 0.3 voxel, filtered by every filter that removes
noise and by those of other libraries with the parameters in which they have one.
Noise left: the deviation of densities from the exact one far from the surface, as a share of what it was.
Surface: at points of the exact surface, how far along the normal the isosurface of the result lies; moved: how far its mean
place is from that without the filter.
"none" is the program's default: no filter costs nothing, and only the plot without a time can show it.
A second volume, a ball with a density that falls linearly from its middle and has no noise, shows how far a Gaussian moves a
curved surface: by sigma^2 / R.)";

}  // namespace

Study filterStudy() {
  return {.name = "filters",
          .title = "Filters: noise left and surface moved against time",
          .words = asParagraph(kFilterWords),
          .on_gpu = true,
          .rounds = 5,
          .seconds = 150,
          .quick_seconds = 20,
          .cells = filterCells,
          .plots = filterPlots,
          .orders = filterOrders,
          .counts = {"surface_lost"},
          .counts_by = {"library"}};
}

}  // namespace palpate
