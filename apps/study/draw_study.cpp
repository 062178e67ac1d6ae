// SPDX-License-Identifier: Apache-2.0
// The study of drawing: depth error against the time for a picture, by kernel and voxel size.
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "apps/bench/bench_views.hpp"
#include "apps/bench/depth_errors.hpp"
#include "apps/bench/half_voxel_march.hpp"
#include "apps/rivals/rivals.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/studies.hpp"
#include "apps/study/study_gpu.hpp"
#include "base/stopwatch.hpp"
#include "engine/draw/drawing.hpp"

namespace palpate {
namespace {

constexpr const char* kCellTree = "Palpate, cell tree";
constexpr const char* kHalfVoxels = "Palpate before, half-voxel steps";
constexpr const char* kLevelSet = "OpenVDB, level set";
constexpr double kDrawnRadius_m = 20e-3;  // of the ball; the knot has the same extent

// Voxels of a volume of a given extent: the ball's radius is 0.35 of the edge between outermost voxels.
double drawnSpacing_m(int edge) {
  return kDrawnRadius_m / (0.35 * (edge - 1));
}

// A phantom ready to be drawn by everyone.
struct DrawnVolume {
  DrawnVolume(const std::string& phantom_name, StudyGpu& on)
      : phantom(makePhantom(phantom_name)),
        volume(makeVolume(*phantom)),
        pool(on.gpu, on.transfer, volume),
        bounds(on.gpu, pool),
        dense(volume.toDense()),
        openvdb({volume.size(), volume.lattice().spacing_m, dense}, std::max(1U, std::thread::hardware_concurrency())) {
    bounds.run();
    drawing = std::make_unique<Drawing>(on.gpu, on.transfer, pool, bounds);
    before = std::make_unique<HalfVoxelMarch>(on.gpu, on.transfer, pool, bounds);
  }
  std::unique_ptr<Phantom> phantom;
  Volume volume;
  BrickPool pool;
  BrickBoundsPass bounds;
  std::vector<float> dense;
  OpenVdbRivals openvdb;
  std::unique_ptr<Drawing> drawing;
  std::unique_ptr<HalfVoxelMarch> before;
};

struct DrawnView {
  std::string phantom;
  int edge = 64, view = 0;
  bool operator<(const DrawnView& other) const {
    return std::tie(phantom, edge, view) < std::tie(other.phantom, other.edge, other.view);
  }
};

// The last depths of a cell, and their errors, which take longer to find than the picture.
struct KnownErrors {
  std::vector<float> distance_m;
  DepthErrors errors;
};

class DrawStage {
 public:
  explicit DrawStage(const StudySettings& settings) : settings_(settings) {}

  CellFigures run(const std::string& kernel, const DrawnView& view) {
    DrawnVolume& on = volumes_.of({view.phantom, view.edge}, [&] {
      const std::string name =
          fmt::format("phantom:{}?size={}&spacing={}mm", view.phantom, view.edge, 1e3 * drawnSpacing_m(view.edge));
      return std::make_unique<DrawnVolume>(name, gpu_.of(settings_.gpu));
    });
    const Camera camera = cameraOf(on.volume, view.view);
    RenderedImage image;
    const double ms = draw(kernel, on, camera, image);
    KnownErrors& known = known_.of({kernel, view}, [] { return std::make_unique<KnownErrors>(); });
    if (known.distance_m != image.distance_m) {
      constexpr int kStride = 4;
      known = {image.distance_m, depthErrors(image, camera, *on.phantom, kStride)};
    }
    const DepthErrors& errors = known.errors;
    const double voxel_um = 1e6 * drawnSpacing_m(view.edge);
    return {{{"depth_error_median_um", voxel_um * errors.voxel.p50},
             {"depth_error_p99_um", voxel_um * errors.voxel.p99},
             {"depth_error_median_voxel", errors.voxel.p50},
             {"holes", static_cast<std::int64_t>(errors.holes)},
             {"false_hits", static_cast<std::int64_t>(errors.false_hits)}},
            {{"wall_ms", ms}}};
  }

 private:
  // From the same side at every voxel size.
  [[nodiscard]] Camera cameraOf(const Volume& volume, int view) const {
    Random random(settings_.seed);
    Camera camera;
    for (int i = 0; i <= view; ++i) {
      camera = settings_.quick ? randomView(volume, random, 320, 240) : randomView(volume, random, 480, 360);
    }
    return camera;
  }

  // The time of a picture that no kernel needs to be compiled and no tree to be made for [ms].
  static double draw(const std::string& kernel, DrawnVolume& on, const Camera& camera, RenderedImage& image) {
    const double isovalue = on.phantom->isovalue();
    if (kernel == kCellTree) {
      on.drawing->show(camera, isovalue);
      const Stopwatch watch;
      on.drawing->finish();
      const double ms = 1e3 * watch.seconds();
      image = on.drawing->image();
      return ms;
    }
    if (kernel == kHalfVoxels) {
      on.before->show(camera, isovalue);
      const Stopwatch watch;
      on.before->finish();
      const double ms = 1e3 * watch.seconds();
      image = on.before->image();
      return ms;
    }
    const RivalView view{inFieldFrame(camera, on.volume.lattice()), isovalue};
    const RunCost cost = on.openvdb.picturesOf(view).front().run(nullptr);
    image.width = camera.width;
    image.height = camera.height;
    image.distance_m = on.openvdb.distancesOf(view);  // unmeasured
    return cost.wall_ms;
  }

  StudySettings settings_;
  LazyGpu gpu_;
  Shared<std::pair<std::string, int>, DrawnVolume> volumes_;
  Shared<std::pair<std::string, DrawnView>, KnownErrors> known_;
};

std::vector<int> drawnEdges(bool quick) {
  return quick ? std::vector{32, 64, 128} : std::vector{32, 64, 96, 128, 192, 256};
}

std::vector<StudyCell> drawCells(const StudySettings& settings) {
  const auto stage = std::make_shared<DrawStage>(settings);
  std::vector<StudyCell> cells;
  for (const char* phantom : {"sphere", "knot"}) {
    for (const int edge : drawnEdges(settings.quick)) {
      for (int view = 0; view < (settings.quick ? 1 : 2); ++view) {
        for (const char* kernel : {kCellTree, kHalfVoxels, kLevelSet}) {
          cells.push_back({{{"kernel", kernel},
                            {"volume", phantom},
                            {"edge_voxels", std::int64_t{edge}},
                            {"voxel_mm", 1e3 * drawnSpacing_m(edge)},
                            {"view", std::int64_t{view}}},
                           [=] {
                             return stage->run(kernel, {phantom, edge, view});
                           }});
        }
      }
    }
  }
  return cells;
}

std::vector<StudyPlot> drawPlots(bool quick) {
  const auto plot = [](const std::string& title, const BenchRow& like) {
    return StudyPlot{.title = title,
                     .like = like,
                     .x = "wall_ms",
                     .x_label = "time for a picture [ms]",
                     .y = "depth_error_median_um",
                     .y_label = "depth off the exact surface, median [um]",
                     .series = {"kernel"},
                     .labels = {"edge_voxels"},
                     .standard = {},
                     .own = "kernel"};
  };
  std::vector<StudyPlot> plots;
  for (const char* volume : {"sphere", "knot"}) {
    BenchRow like = {{"volume", volume}, {"view", std::int64_t{0}}};
    plots.push_back(plot(fmt::format("{}, all voxel sizes", volume), like));
    like.emplace_back("edge_voxels", std::int64_t{drawnEdges(quick).back()});
    plots.push_back(plot(fmt::format("{}, the finest voxels", volume), like));
    plots.back().standard = {{"kernel", kCellTree}};
  }
  StudyPlot sizes = plot("voxel size", {{"volume", "sphere"}, {"view", std::int64_t{0}}});
  sizes.x = "voxel_mm";
  sizes.x_label = "voxel [mm]; the ball has 20 mm";
  sizes.front = false;
  sizes.labels = {};
  plots.push_back(std::move(sizes));
  return plots;
}

// Between samples the field is trilinear, so a surface of radius R is off by some h^2 / R.
std::vector<StudyOrder> drawOrders(bool /*quick*/) {
  return {{.what = "depth error against the size of a voxel",
           .family = {"kernel", "volume", "view"},
           .x = "voxel_mm",
           .y = "depth_error_median_um",
           .theory = [](const BenchRow& row) {
             return textOf(row, "kernel") == kCellTree ? 2.0 : std::numeric_limits<double>::quiet_NaN();
           }}};
}

void drawPromises(BenchResult& result) {
  promise(result, {.name = "drawing: holes and false hits of the cell tree [pixel]",
                   .bound = 0,
                   .part = "drawing",
                   .like = {{"kernel", kCellTree}},
                   .keys = {"holes", "false_hits"},
                   .of = sumOf});
}

constexpr const char* kDrawWords = R"(
A ball of 20 mm and a knot of the same extent, cut into voxels of several sizes and drawn from the same side; a ray for each
pixel, 480 x 360 (quick: 320 x 240).
Depths are compared with the exact distance along the ray to the phantom's surface.
OpenVDB's ray tracer draws a level set that is made of the isosurface beforehand, which takes it longer than the picture.
VTK's ray caster gives no depths; `palpate bench render` has its times.)";

}  // namespace

Study drawStudy() {
  return {.name = "drawing",
          .title = "Drawing: depth error against the time for a picture",
          .words = asParagraph(kDrawWords),
          .on_gpu = true,
          .rounds = 5,
          .seconds = 250,
          .quick_seconds = 15,
          .cells = drawCells,
          .plots = drawPlots,
          .orders = drawOrders,
          .promise = drawPromises,
          .counts = {"holes", "false_hits"},
          .counts_by = {"kernel"}};
}

}  // namespace palpate
