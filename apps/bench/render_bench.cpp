// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/render_bench.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "apps/bench/bench_views.hpp"
#include "apps/bench/columns.hpp"
#include "apps/bench/depth_errors.hpp"
#include "apps/bench/field_bench.hpp"
#include "apps/bench/half_voxel_march.hpp"
#include "apps/bench/head_volume.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/turns.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/rivals/rivals.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/draw/drawing.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

constexpr const char* kRenderBench = "palpate bench render";
constexpr const char* kOurs = "cell tree";
constexpr const char* kBefore = "half-voxel steps";
constexpr double kMostOfOthers = 0.4;  // of the time of the kernel before, and of other libraries
// At 256 voxels along an edge. What a surface bends within a voxel, and with it the error in voxels, falls with the
// size.
constexpr double kMostMedianError_voxel = 0.01;
constexpr double kSizeOfThat = 256;

std::string nameOf(const std::string& phantom, int size) {
  return fmt::format("{} {}^3", phantom, size);
}

struct RenderRow {
  std::string volume;
  std::int64_t view;
  std::string kernel;
  std::int64_t pixels, repetitions;
  double hit_share;  // of the pixels
  Percentiles us_a_pixel;
  double ours_over_this;              // ratio of the medians
  std::optional<DepthErrors> errors;  // where the surface is known, and the kernel finds depths
  std::int64_t seed;
};

double errorOf(const RenderRow& row, double Percentiles::*figure) {
  return row.errors ? row.errors->voxel.*figure : std::numeric_limits<double>::quiet_NaN();
}

const Columns<RenderRow>& renderColumns() {
  static const Columns<RenderRow> kColumns = {
      {"volume", &RenderRow::volume, {"volume", ""}},
      {"view", &RenderRow::view, {"view", ""}},
      {"kernel", &RenderRow::kernel, {"kernel", ""}},
      {"pixels", &RenderRow::pixels},
      {"hit_share", &RenderRow::hit_share, {"hit", "-", 2}},
      {"repetitions", &RenderRow::repetitions},
      {"time_median_us_a_pixel", [](const RenderRow& row) { return row.us_a_pixel.p50; }, {"time", "us/pixel", 3}},
      {"time_max_us_a_pixel", [](const RenderRow& row) { return row.us_a_pixel.max; }, {"max", "us/pixel", 3}},
      {"palpate_over_this", &RenderRow::ours_over_this, {"Palpate/this", "-", 2}},
      {"error_median_voxel",
       [](const RenderRow& row) { return errorOf(row, &Percentiles::p50); },
       {"error", "voxel", 4}},
      {"error_p99_voxel", [](const RenderRow& row) { return errorOf(row, &Percentiles::p99); }, {"p99", "voxel", 3}},
      {"error_max_voxel", [](const RenderRow& row) { return errorOf(row, &Percentiles::max); }, {"max", "voxel", 2}},
      {"holes",
       [](const RenderRow& row) { return row.errors ? static_cast<std::int64_t>(row.errors->holes) : 0; },
       {"holes", ""}},
      {"false_hits",
       [](const RenderRow& row) { return row.errors ? static_cast<std::int64_t>(row.errors->false_hits) : 0; },
       {"false", ""}},
      {"seed", &RenderRow::seed}};
  return kColumns;
}

double hitShare(const RenderedImage& image) {
  std::size_t hits = 0;
  for (const float distance_m : image.distance_m) hits += std::isfinite(distance_m);
  return static_cast<double>(hits) / static_cast<double>(image.distance_m.size());
}

class RenderBench {
 public:
  RenderBench(const RenderBenchRequest& request, Progress& progress)
      : request_(request),
        progress_(progress),
        gpu_(gpu::GpuRequest{.name = request.gpu}),
        transfer_(gpu_),
        threads_(std::max(1U, std::thread::hardware_concurrency())),
        python_(threads_, request.python),
        result_(beginBench("render", gpu_.info().name)) {
    for (const MissingRival& missing : python_.missing()) {
      if (missing.library == "VTK")
        result_.note(fmt::format("no comparison with {}: {}", missing.library, missing.why));
    }
  }

  // `phantom`: null where the exact surface is not known.
  void measure(const std::string& name, const Volume& volume, double isovalue, const Phantom* phantom) {
    progress_.stage("drawing " + name);
    const BrickPool pool(gpu_, transfer_, volume);
    BrickBoundsPass bounds(gpu_, pool);
    bounds.run();
    Drawing drawing(gpu_, transfer_, pool, bounds);
    HalfVoxelMarch before(gpu_, transfer_, pool, bounds);
    const std::vector<float> dense = volume.toDense();
    const RivalField field{volume.size(), volume.lattice().spacing_m, dense};
    const OpenVdbRivals openvdb(field, threads_);
    if (const auto why = python_.load(field)) result_.note(fmt::format("no comparison with VTK: {}", *why));
    Random random(request_.seed);
    for (int view = 0; view < request_.views; ++view) {
      progress_.fraction(static_cast<double>(view) / request_.views);
      const Camera camera = randomView(volume, random, request_.width, request_.height);
      const RivalView seen{inFieldFrame(camera, volume.lattice()), isovalue};
      std::vector<Rival> rivals;
      const auto offer = [&](const std::string& library, const auto& made) {
        without(library, failureOf([&] {
                  for (Rival& rival : made()) rivals.push_back(std::move(rival));
                }));
      };
      offer("OpenVDB", [&] { return openvdb.picturesOf(seen); });
      offer("VTK", [&] {
        std::vector<Rival> theirs = python_.rivalsOf("picture");
        if (!theirs.empty()) python_.see(seen);
        return theirs;
      });
      measureView(name, view, camera, isovalue, drawing, before, rivals, phantom);
    }
  }
  BenchResult& result() { return result_; }

 private:
  void without(const std::string& library, const std::string& why) {
    if (!why.empty()) result_.note(fmt::format("no comparison with {} here: {}", library, why));
  }
  void measureView(const std::string& name, int view, const Camera& camera, double isovalue, Drawing& drawing,
                   HalfVoxelMarch& before, std::vector<Rival>& rivals, const Phantom* phantom) {
    const double pixels = static_cast<double>(camera.width) * camera.height;
    std::vector<double> ours_us, before_us;
    const auto draw = [&] {
      throwIfInterrupted(kRenderBench);
      drawing.show(camera, isovalue);
      const Stopwatch watch;
      drawing.finish();
      ours_us.push_back(1e6 * watch.seconds() / pixels);
    };
    const auto drawBefore = [&] {
      throwIfInterrupted(kRenderBench);
      before.show(camera, isovalue);
      const Stopwatch watch;
      before.finish();
      before_us.push_back(1e6 * watch.seconds() / pixels);
    };
    draw();  // kernels compiled, trees made, speed known
    drawBefore();
    std::vector<double> rivals_hit;
    std::erase_if(rivals, [&](const Rival& rival) {  // those that fail
      std::vector<float> covered;
      const std::string why = failureOf([&] { static_cast<void>(rival.run(&covered)); });
      without(rival.library, why);
      if (why.empty()) rivals_hit.push_back(std::accumulate(covered.begin(), covered.end(), 0.0) / pixels);
      return !why.empty();
    });
    std::vector<std::vector<double>> rivals_us(rivals.size());
    ours_us.clear();
    before_us.clear();
    for (int n = 0; n < request_.repetitions; ++n) {
      n % 2 == 0 ? draw() : drawBefore();
      n % 2 == 0 ? drawBefore() : draw();
      for (std::size_t i = 0; i < rivals.size(); ++i) {
        throwIfInterrupted(kRenderBench);
        without(rivals[i].library,
                failureOf([&] { rivals_us[i].push_back(1e3 * rivals[i].run(nullptr).wall_ms / pixels); }));
      }
    }
    const auto add = [&](const std::string& kernel, const std::vector<double>& us, double hit_share,
                         const std::optional<DepthErrors>& errors) {
      addFigures(
          result_.rows.emplace_back(BenchRow{{"part", "picture"}}), renderColumns(),
          {name, view, kernel, static_cast<std::int64_t>(pixels), request_.repetitions, hit_share, percentiles(us),
           percentiles(ours_us).p50 / percentiles(us).p50, errors, static_cast<std::int64_t>(request_.seed)});
    };
    const auto addOwn = [&](const char* kernel, const std::vector<double>& us, const RenderedImage& drawn) {
      std::optional<DepthErrors> errors;
      if (phantom != nullptr) errors = depthErrors(drawn, camera, *phantom, 4);
      add(kernel, us, hitShare(drawn), errors);
    };
    addOwn(kOurs, ours_us, drawing.image());
    addOwn(kBefore, before_us, before.image());
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      if (!rivals_us[i].empty())
        add(rivals[i].library + " " + rivals[i].way, rivals_us[i], rivals_hit[i], std::nullopt);
    }
  }

  const RenderBenchRequest& request_;
  Progress& progress_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  unsigned threads_;
  PythonRivals python_;
  BenchResult result_;
};

void addTargets(BenchResult& result, const RenderBenchRequest& request) {
  std::vector<std::string> others;
  for (const BenchRow* row : rowsOf(result, "picture")) {
    const std::string kernel = textOf(*row, "kernel");
    if (kernel != kOurs && std::find(others.begin(), others.end(), kernel) == others.end()) others.push_back(kernel);
  }
  for (const std::string& other : others) {
    promise(result, {.name = fmt::format("time of a picture / of {}, the largest of all volumes and views [-]", other),
                     .bound = kMostOfOthers,
                     .part = "picture",
                     .like = {{"kernel", other}},
                     .keys = {"palpate_over_this"},
                     .of = largestOf});
  }
  for (const int size : request.sizes) {
    for (const std::string& phantom : request.phantoms) {
      const std::string volume = nameOf(phantom, size);
      const BenchRow like = {{"kernel", kOurs}, {"volume", volume}};
      promise(result, {.name = fmt::format("median error of depth, {} [voxel]", volume),
                       .bound = kMostMedianError_voxel * kSizeOfThat / size,
                       .part = "picture",
                       .like = like,
                       .keys = {"error_median_voxel"},
                       .of = largestOf});
      promise(result, {.name = fmt::format("holes and false hits, {} [pixel]", volume),
                       .bound = 0,
                       .part = "picture",
                       .like = like,
                       .keys = {"holes", "false_hits"},
                       .of = sumOf});
    }
  }
}

}  // namespace

BenchResult runRenderBench(const RenderBenchRequest& request, Progress& progress) {
  RenderBench bench(request, progress);
  for (const int size : request.sizes) {
    for (const std::string& kind : request.phantoms) {
      const auto phantom = makePhantom(fmt::format("phantom:{}?size={}", kind, size));
      bench.measure(nameOf(kind, size), makeVolume(*phantom), phantom->isovalue(), phantom.get());
    }
  }
  const std::string head = headVolume();
  if (!head.starts_with("phantom:") && request.scan) {
    progress.stage("loading " + head);
    const Volume volume = loadVolume(head);
    bench.measure(std::filesystem::path(head).filename().string(), volume, defaultIsovalue(volume), nullptr);
  }
  addTargets(bench.result(), request);
  return bench.result();
}

std::string renderTable(const BenchResult& result) {
  return tableText(result, {{"picture"}, shown(renderColumns())});
}

LogCharts renderCharts(const BenchResult& result) {
  ChartPanel panel{"median error of depth against time", "time [us/pixel]", "error [voxel]", {}};
  for (const char* kernel : {kOurs, kBefore}) {
    ChartSeries series{kernel, {}};
    for (const BenchRow* row : rowsOf(result, "picture", {{"kernel", kernel}})) {
      const double error = figureOf(*row, "error_median_voxel");
      if (!std::isnan(error)) series.points.push_back({figureOf(*row, "time_median_us_a_pixel"), error});
    }
    panel.series.push_back(std::move(series));
  }
  return {{"Drawing", {panel}, ChartMarks::kPoints}};
}

}  // namespace palpate
