// SPDX-License-Identifier: Apache-2.0
// The study of the whole chain, from the volume to the force: voxel size and precision, against memory and time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "apps/bench/tick_cost.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/studies.hpp"
#include "base/stopwatch.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/service/engine.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace {

constexpr double kChainExtent_m = 57.143e-3;  // between the outermost voxels: the knot's tube has a radius of 3.7 mm
constexpr double kChainDepth_m = 1e-3;
constexpr int kCoarsestChain = 48;  // voxels along an edge; a tool's path is made for it, and is the same for all
constexpr const char* kChainKnot = "knot";
constexpr const char* kChainBall = "sphere";  // of 20 mm

struct Chain {
  std::string volume = kChainKnot;
  int edge = kCoarsestChain;
  std::string algorithm = "hri";
  int n = Scene{}.plane_renewal_ticks;
  std::string storage = "float";
};

double chainVoxel_m(int edge) {
  return kChainExtent_m / (edge - 1);
}

std::unique_ptr<Phantom> chainPhantom(const std::string& volume, int edge) {
  return makePhantom(fmt::format("phantom:{}?size={}&spacing={}mm", volume, edge, 1e3 * chainVoxel_m(edge)));
}

// What the parts of a run cost and hold.
struct ChainCost {
  double start_ms = 0;        // from the volume in main memory to the first tick
  double loop_us_a_tick = 0;  // windows and ticks
  double memory_MiB = 0;      // on the device, and the isosurface's mesh
};

class ChainStage {
 public:
  explicit ChainStage(const StudySettings& settings) : settings_(settings) {}

  CellFigures run(const Chain& chain) {
    const Ground& on = grounds_.of({chain.volume, chain.edge},
                                   [&] { return std::make_unique<Ground>(chainPhantom(chain.volume, chain.edge)); });
    const ContactPath& path =
        paths_.of(chain.volume, [&] { return std::make_unique<ContactPath>(makePath(chain.volume)); });
    ChainCost cost;
    const TouchErrors errors = touch(chain, on, path, cost);
    const double voxel_um = 1e6 * chainVoxel_m(chain.edge);
    return {{{"vhip_error_median_um", voxel_um * errors.vhip_voxel.p50},
             {"vhip_error_p99_um", voxel_um * errors.vhip_voxel.p99},
             {"force_error_p99_percent", errors.force_percent.p99},
             {"force_angle_median_deg", errors.angle_deg.p50},
             {"force_angle_p99_deg", errors.angle_deg.p99},
             {"fall_throughs", errors.falls},
             {"memory_MiB", cost.memory_MiB}},
            {{"start_ms", cost.start_ms}, {"loop_us_a_tick", cost.loop_us_a_tick}}};
  }

 private:
  // A volume as it lies in main memory.
  struct Ground {
    explicit Ground(std::unique_ptr<Phantom> of) : phantom(std::move(of)), volume(makeVolume(*phantom)) {}
    std::unique_ptr<Phantom> phantom;
    Volume volume;
  };

  [[nodiscard]] ContactPath makePath(const std::string& volume) const {
    return contactPath(*chainPhantom(volume, kCoarsestChain),
                       {.rate_hz = kBenchRate_hz,
                        .depth_voxel = kChainDepth_m / chainVoxel_m(kCoarsestChain),
                        .ticks = static_cast<std::size_t>(settings_.quick ? 500 : 1500),
                        .seed = settings_.seed});
  }

  TouchErrors touch(const Chain& chain, const Ground& on, const ContactPath& path, ChainCost& cost) const {
    const AlgorithmEntry& entry = algorithmEntry(chain.algorithm);
    const double isovalue = static_cast<float>(on.phantom->isovalue());
    const Stopwatch start;
    std::shared_ptr<const ContactObject> object;
    std::size_t mesh_bytes = 0;
    if (entry.needs.isosurface_mesh) {
      TriangleMesh mesh = isosurfaceMesh(on.volume, isovalue);
      mesh_bytes = meshBytes(mesh);
      object = std::make_shared<const MeshObject>(std::move(mesh), "isosurface");
    }
    EngineRequest request;
    request.gradient_all = entry.needs.gradient_everywhere;
    request.half_samples = chain.storage == "half";
    Engine engine(on.volume, makePlan(request), isovalue, settings_.gpu);
    const auto haptic = makeAlgorithm(chain.algorithm, {.parameters = {.isovalue = isovalue,
                                                                       .stiffness_N_per_m = kBenchStiffness_N_per_m,
                                                                       .damping_Ns_per_m = 0,
                                                                       .plane_renewal_ticks = chain.n},
                                                        .isosurface = object});
    cost.start_ms = 1e3 * start.seconds();
    cost.memory_MiB = static_cast<double>(engine.memory().back().bytes + mesh_bytes) / (1 << 20);
    TouchTally tally(*on.phantom, path, entry.traits);
    cost.loop_us_a_tick = slide_us(engine, *haptic, path, tally);
    return tally.taken();
  }

  static std::size_t meshBytes(const TriangleMesh& mesh) {
    return mesh.vertices_W.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(mesh.triangles.front());
  }

  // The engine publishes in step, before each tick. Returns the mean time of both [us].
  static double slide_us(Engine& engine, Algorithm& haptic, const ContactPath& path, TouchTally& tally) {
    TickOutput out;
    double seconds = 0;
    haptic.reset(path.hip_W.front());
    for (std::size_t k = 0; k < path.ticks(); ++k) {
      const auto now_ns = static_cast<std::int64_t>(1e9 / kBenchRate_hz * static_cast<double>(k + 1));
      const Stopwatch watch;
      engine.publishFor({.position_W = path.hip_W[k],
                         .velocity_W = path.velocity_W[k],
                         .tick = static_cast<std::int64_t>(k),
                         .time_ns = now_ns,
                         .at_surface = out.at_surface,
                         .surface_W = out.surface_W},
                        now_ns);
      haptic.tick({path.hip_W[k], path.velocity_W[k], &engine.exchange().latest()}, out);
      seconds += watch.seconds();
      tally.add(k, out);
    }
    return 1e6 * seconds / static_cast<double>(path.ticks());
  }

  StudySettings settings_;
  Shared<std::string, ContactPath> paths_;
  Shared<std::pair<std::string, int>, Ground> grounds_;
};

std::vector<int> chainEdges(bool quick) {
  return quick ? std::vector{kCoarsestChain, 64, 96} : std::vector{kCoarsestChain, 64, 96, 128, 192};
}

std::vector<StudyCell> chainCells(const StudySettings& settings) {
  const auto stage = std::make_shared<ChainStage>(settings);
  std::vector<StudyCell> cells;
  const auto add = [&](const Chain& chain) {
    cells.push_back({{{"volume", chain.volume},
                      {"algorithm", chain.algorithm},
                      {"n_ticks", std::int64_t{chain.n}},
                      {"n", algorithmEntry(chain.algorithm).traits.renews_planes ? fmt::format("n={}", chain.n) : ""},
                      {"storage", chain.storage},
                      {"edge_voxels", std::int64_t{chain.edge}},
                      {"voxel_mm", 1e3 * chainVoxel_m(chain.edge)},
                      {"voxel", fmt::format("{:.2g} mm", 1e3 * chainVoxel_m(chain.edge))}},
                     [=] { return stage->run(chain); }});
  };
  for (const int edge : chainEdges(settings.quick)) {
    for (const AlgorithmEntry& entry : algorithms()) {
      if (!entry.traits.shows_surface) continue;
      const std::string name(entry.name);
      add({kChainKnot, edge, name, Scene{}.plane_renewal_ticks, "float"});
      if (name == "blezek") add({kChainBall, edge, name, 1, "float"});
      if (name != Scene{}.algorithm) continue;
      add({kChainKnot, edge, name, Scene{}.plane_renewal_ticks, "half"});
      add({kChainKnot, edge, name, 1, "float"});
      add({kChainBall, edge, name, 1, "float"});
      add({kChainBall, edge, name, 1, "half"});
    }
  }
  return cells;
}

std::vector<StudyPlot> chainPlots(bool quick) {
  const BenchRow usual = {{"volume", kChainKnot}, {"fall_throughs", std::int64_t{0}}};
  const std::int64_t finest = chainEdges(quick).back();
  const auto plot = [&](const char* title, const char* x, const char* x_label, const char* y, const char* y_label) {
    return StudyPlot{.title = title,
                     .like = usual,
                     .x = x,
                     .x_label = x_label,
                     .y = y,
                     .y_label = y_label,
                     .series = {"algorithm", "n", "storage"},
                     .labels = {"voxel"},
                     .standard = {{"algorithm", Scene{}.algorithm},
                                  {"n_ticks", std::int64_t{Scene{}.plane_renewal_ticks}},
                                  {"storage", Scene{}.samples},
                                  {"edge_voxels", finest}},
                     .own = "algorithm"};
  };
  constexpr const char* kMemory = "memory of the device and of a mesh [MiB]";
  constexpr const char* kStart = "start, from the volume to the first tick [ms]";
  constexpr const char* kLoop = "windows and ticks [us a tick]";
  constexpr const char* kPlace = "error of the position, p99 [um]";
  constexpr const char* kAngle = "angle of the force off the normal, p99 [degree]";
  StudyPlot sizes = plot("voxel size, a ball, n=1", "voxel_mm", "voxel [mm]", "vhip_error_median_um",
                         "error of the position, median [um]");
  sizes.like = {{"volume", kChainBall}};
  sizes.front = false;
  sizes.standard = {};
  sizes.labels = {};
  return {plot("position, memory", "memory_MiB", kMemory, "vhip_error_p99_um", kPlace),
          plot("position, start", "start_ms", kStart, "vhip_error_p99_um", kPlace),
          plot("position, loop", "loop_us_a_tick", kLoop, "vhip_error_p99_um", kPlace),
          plot("angle, memory", "memory_MiB", kMemory, "force_angle_p99_deg", kAngle),
          plot("angle, start", "start_ms", kStart, "force_angle_p99_deg", kAngle),
          std::move(sizes)};
}

// With a plane in every tick nothing but the samples is left: trilinear interpolation, of second order. The angle has
// none: hri is content with a plane whose normal line passes the tool within 0.02 voxel, which turns the normal by more
// than central differences do (their order is in the study of gradients), and blezek has a tolerance too.
double orderOfPosition(const BenchRow& row) {
  return textOf(row, "storage") == "float" ? 2 : std::numeric_limits<double>::quiet_NaN();
}
double noOrder(const BenchRow& /*row*/) {
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<StudyOrder> chainOrders(bool /*quick*/) {
  const auto order = [](const char* what, const char* y, double (*theory)(const BenchRow& row)) {
    return StudyOrder{.what = fmt::format("{} against the size of a voxel", what),
                      .like = {{"volume", kChainBall}},
                      .family = {"algorithm", "storage"},
                      .x = "voxel_mm",
                      .y = y,
                      .theory = theory};
  };
  return {order("error of the position", "vhip_error_median_um", orderOfPosition),
          order("angle of the force", "force_angle_median_deg", noOrder)};
}

void chainPromises(BenchResult& result) {
  promise(result, {.name = "chain: contacts lost by hri [-]",
                   .bound = 0,
                   .part = "chain",
                   .like = {{"algorithm", "hri"}},
                   .keys = {"fall_throughs"},
                   .of = sumOf});
}

constexpr const char* kChainWords = R"(
The knot of 57 mm extent, cut into voxels of several sizes: the engine of the program computes gradients where the isosurface
needs them and publishes windows in step with the servo, which slides 1 mm deep at 0.1 m/s, 1000 ticks a second.
Samples are stored as floats or as halves.
Memory: all that the device holds, and for the algorithm that touches a mesh the mesh.
Start: from the volume in main memory to the first tick, device and kernels included, whose driver's cache is warm.
The tool's path is the same for all.
A ball of 20 mm with a new plane in every tick shows the orders of convergence.)";

}  // namespace

Study chainStudy() {
  return {.name = "chain",
          .title = "The whole chain: error against memory and time",
          .words = asParagraph(kChainWords),
          .on_gpu = true,
          .rounds = 5,
          .seconds = 200,
          .quick_seconds = 30,
          .cells = chainCells,
          .plots = chainPlots,
          .orders = chainOrders,
          .promise = chainPromises,
          .counts = {"fall_throughs"},
          .counts_by = {"algorithm", "n", "storage"}};
}

}  // namespace palpate
