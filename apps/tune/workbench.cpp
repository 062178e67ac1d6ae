// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/workbench.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/touch/scene_plan.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/touch/servo_run.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/phantoms/phantom.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

void stopTuningIfInterrupted() {
  throwIfInterrupted("palpate tune");
}

Scene forTrials(Scene scene) {
  scene.simulated_clock = true;
  scene.device = defaultDevice();
  scene.edit.clear();
  return scene;
}

// What the scene leaves to the program is fixed to what `path` has.
Scene withPathOf(Scene scene, const ScriptedPath& path) {
  if (!scene.path_file.empty()) return scene;
  if (!scene.path_start_W) scene.path_start_W = path.start_W;
  if (!scene.path_slide) scene.path_slide = path.slide_W;
  if (!scene.press_depth_m) scene.press_depth_m = path.depth_m;
  if (!scene.slide_length_m) scene.slide_length_m = path.slide_m;
  if (!scene.approach_m) scene.approach_m = path.approach_m;
  return scene;
}

std::uint64_t bytesOf(const TriangleMesh& mesh) {
  return mesh.vertices_W.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(mesh.triangles.front());
}

// One engine serves every n.
bool shareEngine(const Candidate& a, const Candidate& b) {
  Candidate like_b = a;
  like_b.n = b.n;
  return like_b == b;
}

}  // namespace

// The tool's way on what is felt through a filter, the truth along it, and what is felt besides the engine's windows.
struct Workbench::Ground {
  std::optional<ScriptedPath> path;
  std::unique_ptr<Truth> truth;
  std::shared_ptr<const ContactObject> mesh;
  std::uint64_t mesh_bytes = 0;
  double mesh_ms = 0;
  DensityScale scale;
};

struct Workbench::Made {
  Candidate candidate;
  std::unique_ptr<Engine> engine;
  double start_ms = 0;
};

Workbench::Workbench(const Scene& scene, Progress& progress, const ShelfRoom& room)
    : given_(scene),
      scene_(forTrials(scene)),
      objects_(makeSceneObjects(scene.objects)),
      volume_(loadAndTell(scene.volume, progress)),
      truth_samples_(Scene{}.samples),
      shelf_(room.engines, [share = room.share] {
        return static_cast<std::uint64_t>(share * static_cast<double>(availableMemoryBytes()));
      }) {
  checkTouchable(volume_);
  isovalue_ = static_cast<float>(scene.isovalue ? *scene.isovalue : defaultIsovalue(volume_));
  checkIsovalue(volume_, isovalue_);
  tiny_ = std::make_unique<Engine>(makeVolume(*makePhantom("phantom:sphere?size=8")), makePlan({}), 0, scene.gpu);
  why_not_exact_ = palpate::whyNotExact(withRecordedBrush(scene), isovalue_);
}

Workbench::~Workbench() = default;

// The first engine of a kind waits for the driver's compiler, if the driver has not kept what it compiled for an
// earlier run. Its time to start says nothing of later runs, so it is made again.
std::shared_ptr<Workbench::Made> Workbench::make(const Candidate& candidate) {
  Progress quiet(nullptr);
  const Plan plan = planFor(withCandidate(scene_, candidate));
  auto made = std::make_shared<Made>();
  made->candidate = candidate;
  const std::string kind = fmt::format("{}|{}|{}", candidate.filter, candidate.gradient_operator, candidate.samples);
  for (const bool is_first = kinds_made_.insert(kind).second; const int turn : {0, 1}) {
    if (turn == 1 && !is_first) break;
    made->engine.reset();
    const Stopwatch watch;
    made->engine = std::make_unique<Engine>(volume_, plan, isovalue_, scene_.gpu, scene_.gpu_memory_bytes,
                                            passProgress(quiet, stopTuningIfInterrupted));
    made->start_ms = 1e3 * watch.seconds();
  }
  device_name_ = made->engine->gpu().name;
  return made;
}

// The filtered volume is as large as the volume, and only the path and the mesh need it.
std::shared_ptr<Workbench::Ground> Workbench::groundOf(Engine& engine, const Scene& scene) {
  auto ground = std::make_shared<Ground>();
  std::optional<Volume> filtered;
  if (engine.filters()) filtered = engine.filtered(volume_.facts());
  const Volume& felt = filtered ? *filtered : volume_;
  ground->scale = densityScaleOf(felt, engine.isovalue());
  stopTuningIfInterrupted();
  ground->path = scriptedPath(scene, VolumeSurface(felt, engine.isovalue()));
  ground->truth = newTruth();
  if (algorithmEntry(scene_.algorithm).needs.isosurface_mesh) {
    const Stopwatch watch;
    TriangleMesh mesh = isosurfaceMesh(felt, engine.isovalue());
    ground->mesh_bytes = bytesOf(mesh);
    ground->mesh = std::make_shared<const MeshObject>(std::move(mesh), "isosurface");
    ground->mesh_ms = 1e3 * watch.seconds();
  }
  return ground;
}

// Meshes may be large: of the grounds that hold one, the scene's own and the last one stay.
std::shared_ptr<Workbench::Ground> Workbench::keptGround(const Candidate& candidate) {
  if (const auto known = grounds_.find(candidate.filter); known != grounds_.end()) return known->second;
  const Scene scene = trialScene(candidate);
  std::erase_if(grounds_, [&](const auto& kept) { return kept.second->mesh && kept.first != given_.filter; });
  return grounds_[candidate.filter] = groundOf(*shelved(candidate)->engine, scene);
}

Scene Workbench::sceneOf(const Candidate& candidate) {
  Scene scene = withCandidate(given_, candidate);
  if (candidate.filter == given_.filter) return scene;
  return withPathOf(scene, *keptGround(candidateOf(given_))->path);
}

Scene Workbench::trialScene(const Candidate& candidate) {
  return forTrials(sceneOf(candidate));
}

std::shared_ptr<Workbench::Made> Workbench::shelved(const Candidate& candidate) {
  return shelf_.find([&](const Made& made) { return shareEngine(made.candidate, candidate); },
                     [&] { return make(candidate); },
                     [](const Made& made) { return made.engine->memory().back().bytes; });
}

// Lets the engine go before the truth is looked up, which may need another one.
Trial Workbench::trialOf(const Candidate& candidate, std::shared_ptr<Made> made, Ground& ground) {
  Scene scene = trialScene(candidate);
  if (!scene.path_file.empty()) scene.duration_s = ground.path->path.duration_s();
  checkRunLength(scene, availableMemoryBytes());
  Progress quiet(nullptr);
  const RigVolume rig{.scale = ground.scale, .objects = objects_.objects, .isosurface = ground.mesh};
  made->engine->forgetWindow();  // else the last run's window could save this one a gather
  const auto device = makeDevice(scene.device, deviceSetup(scene, ground.path->path));
  const ServoRun run = runServo(scene, rig, *device, *made->engine, nullptr, quiet, [](const auto&) {});
  stopTuningIfInterrupted();
  Trial trial{.candidate = candidate,
              .loop_us = run.loop_us_a_tick.value_or(0),
              .memory_bytes = made->engine->memory().back().bytes + ground.mesh_bytes,
              .start_ms = made->start_ms + ground.mesh_ms,
              .faulty_ticks = std::ranges::count_if(run.loop.records, [](const auto& r) { return r.faults != 0; })};
  made.reset();
  const RunErrors errors = runErrors(*ground.truth, run.loop.records, ground.path->phases, springStiffness(scene));
  trial.error_N = errors.p99_N;
  trial.contact_share = errors.contact_share;
  return trial;
}

// The engine for the truest settings. Where floats do not fit, the scene's own storage has to do.
std::shared_ptr<Workbench::Made> Workbench::truestMade(Scene& scene) {
  scene.samples = truth_samples_;
  try {
    return shelved(candidateOf(scene));
  } catch (const Error& error) {
    if (error.code() != Error::Code::kOutOfMemory || scene.samples == given_.samples) throw;
  }
  scene.samples = truth_samples_ = given_.samples;
  return shelved(candidateOf(scene));
}

// The places are those of the records: a rigid hand goes from one to the next. Encoders have rounded them already.
std::vector<TickRecord> Workbench::feelTruest(const std::vector<TickRecord>& along) {
  Scene scene = scene_;
  scene.plane_renewal_ticks = 1;
  scene.window_edge = Scene{}.window_edge;
  scene.spring_hand = false;
  scene.encoder_resolution_m = 0;
  scene.device_delay_ticks = 0;
  scene.duration_s = static_cast<double>(along.size()) / scene.rate_hz;
  std::vector<double> times_s;
  std::vector<Vec3> places_W;
  for (const TickRecord& record : along) {
    times_s.push_back(record.time_s);
    places_W.push_back(asVec3(record.hip_W));
  }
  const SampledPath path(std::move(times_s), std::move(places_W), SampledPath::Interpolation::kLinear);
  const std::shared_ptr<Ground> ground = keptGround(candidateOf(scene_));
  const std::shared_ptr<Made> made = truestMade(scene);
  Progress quiet(nullptr);
  const RigVolume rig{.scale = ground->scale, .objects = objects_.objects, .isosurface = ground->mesh};
  made->engine->forgetWindow();
  const auto device = makeDevice(scene.device, deviceSetup(scene, path));
  return runServo(scene, rig, *device, *made->engine, nullptr, quiet, [](const auto&) {}).loop.records;
}

std::unique_ptr<Truth> Workbench::newTruth() {
  if (why_not_exact_.empty()) return exactTruth(scene_.volume);
  return feltTruth([this](const std::vector<TickRecord>& along) { return feelTruest(along); });
}

bool Workbench::isAsGiven(const Candidate& candidate) const {
  return candidate.samples == given_.samples && candidate.filter == given_.filter &&
         candidate.gradient_operator == given_.gradient_operator;
}

// What the scene itself cannot do is the user's to mend.
template <typename Work>
Trial Workbench::orImpossible(const Candidate& candidate, const Work& work) const {
  try {
    return work();
  } catch (const Error& error) {
    const bool by_choice = error.code() == Error::Code::kBadInput || error.code() == Error::Code::kOutOfMemory;
    if (!by_choice || isAsGiven(candidate)) throw;
    return {.candidate = candidate, .impossible = error.reason()};
  }
}

Trial Workbench::feel(const Candidate& candidate) {
  return orImpossible(candidate, [&] {
    const std::shared_ptr<Ground> ground = keptGround(candidate);
    return trialOf(candidate, shelved(candidate), *ground);
  });
}

Trial Workbench::feelAnew(const Candidate& candidate) {
  return orImpossible(candidate, [&] {
    std::shared_ptr<Made> made = shelf_.withRoom([&] { return make(candidate); });
    const std::shared_ptr<Ground> ground = groundOf(*made->engine, trialScene(candidate));
    return trialOf(candidate, std::move(made), *ground);
  });
}

}  // namespace palpate
