// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mask_bench.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/touch_errors.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/mask_shapes.hpp"
#include "apps/study/study_gpu.hpp"
#include "apps/study/surface_offsets.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/pool_volume.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {
namespace {

constexpr double kMaskSpeed_m_per_s = 0.1;
constexpr std::size_t kPlaces = 2000;  // of the exact surface

struct MaskFigures {
  TouchErrors touch;
  SurfaceOffsets surface;
  double voxel_m = 0;
  double moved_percent = 0;  // of the object's volume
};

double shareInContact(const TouchErrors& touch) {
  return 100 * static_cast<double>(touch.contact_ticks) / static_cast<double>(touch.ticks);
}

double lostPercent(const SurfaceOffsets& surface) {
  return 100 * static_cast<double>(surface.lost) / static_cast<double>(kPlaces);
}

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

Column<MaskFigures> figure(const char* key, Percentiles TouchErrors::*of, double Percentiles::*which,
                           const Look& look) {
  return {key,
          [of, which](const MaskFigures& found) {
            return (found.touch.*of).count > 0 ? (found.touch.*of).*which : kNoFigure;
          },
          look};
}

const Columns<MaskFigures>& maskColumns() {
  using F = MaskFigures;
  using P = Percentiles;
  static const Columns<F> kColumns = {
      figure("force_angle_median_deg", &TouchErrors::angle_deg, &P::p50, {"angle", "deg", 1}),
      figure("force_angle_p99_deg", &TouchErrors::angle_deg, &P::p99, {"p99", "deg", 1}),
      figure("vhip_error_median_voxel", &TouchErrors::vhip_voxel, &P::p50, {"place", "voxel", 2}),
      figure("vhip_error_p99_voxel", &TouchErrors::vhip_voxel, &P::p99, {"p99", "voxel", 2}),
      figure("vhip_error_max_voxel", &TouchErrors::vhip_voxel, &P::max, {"max", "voxel", 2}),
      {"surface_off_mean_voxel", [](const F& f) { return f.surface.mean_m / f.voxel_m; }, {"moved", "voxel", 2}},
      {"surface_lost_percent", [](const F& f) { return lostPercent(f.surface); }, {"lost", "%", 1}},
      {"volume_change_percent", [](const F& f) { return f.moved_percent; }, {"volume", "%", 1}},
      {"in_contact_percent", [](const F& f) { return shareInContact(f.touch); }, {"contact", "%", 1}},
      {"force_jump_max_N", [](const F& f) { return f.touch.force_jump_max_N; }, {"jump", "N", 2}},
      {"exact_force_jump_max_N", [](const F& f) { return f.touch.exact_force_jump_max_N; }},
      {"fall_throughs", [](const F& f) { return f.touch.falls; }, {"falls", ""}}};
  return kColumns;
}

constexpr const char* kMaskIntroduction = R"(
Masks (1 in the object, 0 outside) of bodies that are turned and moved, so that no face lies along the lattice, felt
through each chain of filters with the program's default algorithm.
A tool wanders over the body, 2 mm below its exact surface (1 mm in the thin wall), 0.1 m/s, 1000 ticks a second.
On a box it soon follows the edges, where the exact normal jumps by 90 degrees: those rows tell what edges lose.
*Angle*: between the force and the exact normal.
*Place*: distance of the VHIP from the exact surface; in voxels of the smallest spacing, 1 mm.
*Moved*: where the surface of the felt field lies along the exact normal, mean over places of the exact surface; inward is
negative.
*Lost*: places that have no surface within four voxels.
*Volume*: change of the number of voxels in the object.
*Contact*: ticks of the slide in contact; *falls*: how often contact was lost while the tool was a quarter of a voxel
inside.
*Jump*: largest change of the force in a tick, at 500 N/m.
A filter without a unit counts voxels along each axis, one with mm is round in the world.)";

double objectVoxels(const std::vector<float>& values, double isovalue) {
  return static_cast<double>(
      std::count_if(values.begin(), values.end(), [&](float value) { return value > isovalue; }));
}

// A mask in the device's memory, and the way of a tool over the body that was masked.
class MaskStage {
 public:
  MaskStage(StudyGpu& device, const MaskShape& shape, const MaskBenchRequest& request)
      : device_(device),
        shape_(shape),
        request_(request),
        body_(makeMask(shape, request.seed)),
        mask_(makeVolume(*body_)),
        pool_(device.gpu, device.transfer, mask_),
        points_(exactSurfacePoints(*body_, kPlaces, 0, request.seed)),
        path_(contactPath(*body_, {.speed_m_per_s = kMaskSpeed_m_per_s,
                                   .rate_hz = kBenchRate_hz,
                                   .depth_voxel = 1e-3 * shape.depth_mm / body_->lattice().smallestSpacing(),
                                   .ticks = request.ticks,
                                   .seed = request.seed})) {}

  [[nodiscard]] MaskFigures feel(const MaskWay& way) {
    const std::vector<FilterSpec> chain = way.chain.empty() ? std::vector<FilterSpec>{} : filterChain(way.chain);
    const auto isovalue = static_cast<float>(kMaskIsovalue);
    const auto filters =
        filteredBy(device_.gpu, device_.transfer, pool_, lowerFilters(chain, mask_.lattice().spacing_m, isovalue));
    Volume felt = volumeOf(filters ? filters->result() : pool_, device_.transfer, mask_.facts());
    const double surface = isovalueAfter(chain, isovalue);
    MaskFigures found;
    found.voxel_m = mask_.lattice().smallestSpacing();
    const reference::DenseField field = reference::denseField(felt);
    found.surface = surfaceOffsets(field, surface, points_);
    found.moved_percent = 100 * (objectVoxels(field.values, surface) / objectVoxels(mask_.toDense(), isovalue) - 1);
    const BenchVolume samples(makeMask(shape_, request_.seed), std::move(felt), surface,
                              way.gradient.empty() ? GradientOperator{} : gradientOperator(way.gradient));
    Entrant entrant = makeEntrant(samples, Scene{}.algorithm, Scene{}.plane_renewal_ticks);
    found.touch =
        touchErrors(samples, path_, std::span(&entrant, 1), [](double) { throwIfInterrupted(kBenchWords); }).front();
    return found;
  }

 private:
  static constexpr const char* kBenchWords = "palpate bench masks";
  StudyGpu& device_;
  const MaskShape& shape_;
  const MaskBenchRequest& request_;
  std::unique_ptr<Phantom> body_;
  Volume mask_;
  BrickPool pool_;
  std::vector<ExactSurfacePoint> points_;
  ContactPath path_;
};

}  // namespace

std::string MaskWay::words() const {
  std::string words = chain;
  if (!gradient.empty()) words += (words.empty() ? "" : ", ") + ("normals of " + gradient);
  return words.empty() ? "none" : words;
}

std::vector<MaskWay> maskWays() {
  std::vector<MaskWay> ways = {{}};
  for (const char* chain :
       {"gaussian:0.7", "gaussian:1", "gaussian:1.5", "gaussian:2", "gaussian:3", "gaussian:1.5mm", "gaussian:3mm",
        "median:1", "median:2", "median:3", "open:1:shape=ball close:1:shape=ball", "median:1 gaussian:1",
        "bilateral:1.5:range=0.3", "diffuse:10:kappa=10", "distance:4", "gaussian:1 distance:4",
        "gaussian:1.5 distance:4", "distance:4 gaussian:1", "distance:4 gaussian:1.5"}) {
    ways.push_back({.chain = chain});
  }
  for (const char* gradient : {"gaussian:1.5", "gaussian:2"}) ways.push_back({.gradient = gradient});
  for (const char* both : {"gaussian:0.7", "gaussian:1"}) ways.push_back({.chain = both, .gradient = "gaussian:1"});
  return ways;
}

MaskBenchRequest MaskBenchRequest::quick() {
  MaskBenchRequest request;
  request.shapes = {"ball of 20 voxels", "edges of a box of 24 voxels", "wall of 2.5 voxels",
                    "ball of 20 mm, slices of 3 mm"};
  request.ticks = 1000;
  return request;
}

namespace {

// Without the box, at whose edges no angle says anything.
void promiseMasks(BenchResult& result) {
  struct Bound {
    const char* shape;
    double median_deg, p99_deg;
  };
  // As docs/masks.md states them.
  for (const Bound& bound :
       {Bound{"ball of 10 voxels", 2, 7}, Bound{"ball of 20 voxels", 2, 7}, Bound{"ball of 40 voxels", 2, 7},
        Bound{"ball of 6 voxels", 3.5, 15}, Bound{"tube of 6 voxels", 3.5, 15}, Bound{"wall of 2.5 voxels", 3.5, 15},
        Bound{"ball of 20 mm, slices of 3 mm", 3.5, 15}}) {
    for (const auto& [key, words, most] : {std::tuple("force_angle_median_deg", "median", bound.median_deg),
                                           std::tuple("force_angle_p99_deg", "p99", bound.p99_deg)}) {
      promise(result, {.name = fmt::format("{}, gaussian:1.5: angle, {} [deg]", bound.shape, words),
                       .bound = most,
                       .part = "mask",
                       .like = {{"shape", bound.shape}, {"way", "gaussian:1.5"}},
                       .keys = {key},
                       .of = largestOf});
    }
  }
}

}  // namespace

BenchResult runMaskBench(const MaskBenchRequest& request, Progress& progress) {
  StudyGpu device(request.gpu);
  BenchResult result = beginBench("masks", device.gpu.info().name);
  for (const MaskShape& shape : maskShapes()) {
    const auto& wanted = request.shapes;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), shape.name) == wanted.end()) continue;
    progress.stage(shape.name);
    MaskStage stage(device, shape, request);
    double done = 0;
    for (const MaskWay& way : request.ways) {
      BenchRow row = {{"part", "mask"}, {"shape", shape.name}, {"way", way.words()}};
      addFigures(row, maskColumns(), stage.feel(way));
      result.rows.push_back(std::move(row));
      progress.fraction(++done / static_cast<double>(request.ways.size()));
    }
  }
  promiseMasks(result);
  return result;
}

std::string maskTable(const BenchResult& result) {
  return tableText(result, {{"mask"},
                            joined(TableColumns{{"way", nullptr, {"filter", ""}}}, shown(maskColumns())),
                            [](const BenchRow& row) { return textOf(row, "shape"); }});
}

LogCharts maskCharts(const BenchResult& result) {
  LogChart chart{.title = "How masks are felt", .panels = {}, .marks = ChartMarks::kPoints, .columns = 3};
  for (const BenchRow* row : rowsOf(result, "mask")) {
    const ChartPanel panel{.title = textOf(*row, "shape"),
                           .x_label = "place, p99 [voxel]",
                           .y_label = "angle, p99 [degree]",
                           .series = {}};
    const std::string way = textOf(*row, "way");
    const auto x = numberIn(*row, "vhip_error_p99_voxel"), y = numberIn(*row, "force_angle_p99_deg");
    if (x && y) addPoint(chart.panels, panel, way.substr(0, way.find(':')), {.x = *x, .y = *y, .label = way});
  }
  return {chart};
}

Bench maskBench() {
  const auto run = [](const Bench&, const BenchArguments& arguments, Progress& progress) {
    MaskBenchRequest request = arguments.quick ? MaskBenchRequest::quick() : MaskBenchRequest{};
    request.seed = arguments.seed;
    request.gpu = arguments.gpu;
    return runMaskBench(request, progress);
  };
  return {.name = "masks",
          .help = "how masks are felt through each filter that might help (a minute; --quick: seconds)",
          .title = "How masks are felt",
          .introduction = asParagraph(kMaskIntroduction),
          .takes = {"gpu"},
          .run = run,
          .table = maskTable,
          .charts = maskCharts};
}

}  // namespace palpate
