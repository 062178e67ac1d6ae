// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/touch_job.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/pass_progress.hpp"
#include "apps/console/remark.hpp"
#include "apps/report/html_report.hpp"
#include "apps/report/summary.hpp"
#include "apps/report/trace_csv.hpp"
#include "apps/touch/algorithm_setup.hpp"
#include "apps/touch/exact_errors.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/touch/object_volume.hpp"
#include "apps/touch/output_folder.hpp"
#include "apps/touch/picture.hpp"
#include "apps/touch/run_length.hpp"
#include "apps/touch/run_notes.hpp"
#include "apps/touch/run_results.hpp"
#include "apps/touch/scene_objects.hpp"
#include "apps/touch/scripted_path.hpp"
#include "apps/touch/servo_run.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/atomic_file.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/gpu/gpu_info.hpp"
#include "engine/service/engine.hpp"
#include "engine/volume/isosurface_mesh.hpp"
#include "engine/volume/memory_budget.hpp"
#include "engine/volume/phantom.hpp"
#include "engine/volume/statistics.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/loop/contact_stability.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/velocity.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

void stopIfInterrupted() {
  throwIfInterrupted("palpate touch");
}

// Runs the stages of a job: each is announced, timed, and not begun after Ctrl-C.
class Stages {
 public:
  Stages(Progress& progress, std::vector<StageTime>& times) : progress_(progress), times_(times) {}

  template <typename Work>
  auto run(const char* name, const std::string& words, Work work) {
    stopIfInterrupted();
    progress_.stage(words);
    const Stopwatch watch;
    auto result = work();
    times_.push_back({name, watch.seconds()});
    return result;
  }

 private:
  Progress& progress_;
  std::vector<StageTime>& times_;
};

// Faults of the command line are found before a volume is loaded for them.
void checkEarly(const Scene& scene, const ContactObjects& objects) {
  if (scene.volume.empty()) {
    throw Error(Error::Code::kBadInput, "palpate touch", "no volume is given",
                "name a file, a DICOM folder or a phantom, for example phantom:sphere?size=64");
  }
  // An algorithm that touches a mesh can be made only from the volume's.
  if (!algorithmEntry(scene.algorithm).needs.isosurface_mesh) {
    (void)makeAlgorithm(scene.algorithm, algorithmSetup(scene, scene.isovalue.value_or(0.0), {}, objects));
  }
  VelocityParameters velocity;
  velocity.name = scene.velocity;
  (void)VelocityEstimate(velocity, scene.rate_hz);
  checkEditOptions(scene);
  if (scene.path_file.empty()) checkRunLength(scene, availableMemoryBytes());
}

// The phantom's exact surface lies at its own isovalue; at another one, where the tool may be on an object, and where
// it edits, nothing exact is known.
std::optional<ExactErrors> exactErrorsOf(const TouchRun& run) {
  if (!run.scene.volume.starts_with("phantom:") || !run.scene.objects.empty() || !run.scene.edit.empty())
    return std::nullopt;
  const std::unique_ptr<Phantom> phantom = makePhantom(run.scene.volume);
  if (phantom->isovalue() != run.volume.isovalue) return std::nullopt;
  return exactErrors(*phantom, run.records, run.phases);
}

// On pictures and pages a file goes by its name; the command that repeats the run has its path.
std::string shownName(const VolumeFacts& facts) {
  if (facts.format == "phantom") return facts.source;
  const std::filesystem::path path(facts.source);
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

RunVolume volumeOf(const Volume& volume, double isovalue) {
  return {shownName(volume.facts()), volume.facts().format, volume.size(), volume.lattice().spacing_m,
          volume.minimum(),          volume.maximum(),      isovalue};
}

DensityScale densityScale(const Volume& volume, double isovalue) {
  return {.contrast = volume.maximum() - isovalue, .voxel_m = volume.lattice().smallestSpacing()};
}

std::vector<std::string> planWords(const Plan& plan, const PlanFacts& facts) {
  std::vector<std::string> words;
  for (const PlanLine& line : planLines(plan, facts)) {
    std::string text = fmt::format("{}: {} ({})", line.done ? "done" : "left out", line.what, line.why);
    if (line.saved_bytes > 0) text += "; saves " + inMiB(line.saved_bytes);
    words.push_back(std::move(text));
  }
  return words;
}

std::vector<RunFault> faultsOf(const TouchRun& run) {
  std::vector<RunFault> faults;
  for (const FaultCount& count : figuresOf(run).faults) {
    const auto table = faultTable();
    const auto row =
        std::find_if(table.begin(), table.end(), [&](const FaultText& r) { return r.fault == count.fault; });
    faults.push_back({row->name, count.ticks, count.first_tick, row->text, row->effect, row->remedy});
  }
  return faults;
}

std::vector<std::string> realTimeWords(const Scene& scene, const LoopResult& result) {
  std::vector<std::string> words;
  if (scene.simulated_clock) words.emplace_back("simulated clock: ticks as fast as they compute, no deadlines");
  if (result.real_time.fifo) words.emplace_back("SCHED_FIFO priority");
  if (result.real_time.memory_locked) words.emplace_back("memory locked");
  words.insert(words.end(), result.real_time.notes.begin(), result.real_time.notes.end());
  if (!result.released) words.emplace_back("at the end the device refused a force of zero and may still hold one");
  if (result.ticks_skipped > 0)
    words.push_back(fmt::format("{} grid points left out after missed deadlines", result.ticks_skipped));
  return words;
}

MemoryFigure residentPeak() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {"process peak", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

// Writes everything or nothing; `picture` may be empty.
void writeOutputs(const TouchRun& run, const std::string& picture, OutputFolder& folder) {
  if (run.scene.trace) {
    writeTraceCsv(folder.draft("trace.csv"), run.records, run.ended_early);
  } else {
    folder.leaveOut("trace.csv");
  }
  if (picture.empty()) {
    folder.leaveOut("view.png");
  } else {
    writeFileAtomically(folder.draft("view.png"), picture);
  }
  writeReport(folder.draft("report.html"), run, picture);
  writeSummary(folder.draft("summary.json"), run);
  refuseForeignResults(run.scene.out);  // that came there meanwhile
  folder.publish("summary.json");       // which tells the next run that the others are replaceable
}

std::vector<std::string> outputFiles(const Scene& scene, const OutputFolder& folder, bool has_picture) {
  std::vector<std::string> files;
  if (has_picture) files.push_back(folder.file("view.png").string());
  files.push_back(folder.file("report.html").string());
  files.push_back(folder.file("summary.json").string());
  if (scene.trace) files.push_back(folder.file("trace.csv").string());
  return files;
}

// Of a run that is ended while it tells what was felt.
std::string wordsOfSecondRequest(const Scene& scene) {
  std::string places = scene.journal;
  if (!scene.save.empty()) places += (places.empty() ? "" : " and ") + scene.save;
  return places.empty() ? "nothing was written; start it again"
                        : "no report was written; what was saved of the edits is in " + places;
}

// A tick that the tool did not reach has no phase.
void endPhases(std::vector<PathPhase>& phases, double end_s) {
  std::erase_if(phases, [&](const PathPhase& phase) { return phase.begin_s >= end_s; });
  for (PathPhase& phase : phases) phase.end_s = std::min(phase.end_s, end_s);
}

// Where the user stopped the servo before its time: what was felt until then is told like any run. Throws
// Error(kCancelled) where nothing was.
void endEarly(TouchRun& run) {
  const double wanted = std::round(run.scene.duration_s * run.scene.rate_hz);
  if (!interrupted()) return;
  if (run.records.empty()) stopIfInterrupted();
  const double felt_s = static_cast<double>(run.records.back().tick + 1) / run.scene.rate_hz;
  if (static_cast<double>(run.records.back().tick + 1) >= wanted) return;
  run.ended_early = fmt::format("stopped by the user after {:.3g} s of {:.3g} s", felt_s, run.scene.duration_s);
  endPhases(run.phases, felt_s);
}

// Empty where the plan has none and where the user stops it.
std::string pictureOf(TouchRun& run, const SurfaceField& surface, Engine& engine, Stages& stages) {
  try {
    return stages.run("picture", "drawing", [&] { return drawPicture(run, surface, engine, stopIfInterrupted); });
  } catch (const Error& error) {
    if (error.code() != Error::Code::kCancelled) throw;
  }
  if (run.ended_early.empty()) run.ended_early = "stopped by the user after the run, before the picture";
  return {};
}

}  // namespace

TouchRun runTouchJob(const Scene& scene, const std::string& command, const std::string& commit, Progress& progress) {
  std::optional<KeptWork> kept;  // first, so that it outlives all that takes time to give back
  const SceneObjects objects = makeSceneObjects(scene.objects);
  checkEarly(scene, objects.objects);
  refuseForeignResults(scene.out);
  OutputFolder folder(scene.out);
  TouchRun run;
  run.scene = scene;
  run.machine = readMachineFacts();
  run.commit = commit;
  run.command = command;
  Stages stages(progress, run.stages);

  Volume volume = stages.run("load", "loading " + scene.volume, [&] { return loadVolume(scene.volume); });
  progress.done();
  tellRemark(volume.facts().source, volume.facts().remark);
  checkTouchable(volume);
  // Rounded to float once, as the GPU has it: servo and kernels must agree on what is object.
  const double isovalue = static_cast<float>(scene.isovalue ? *scene.isovalue : defaultIsovalue(volume));
  checkIsovalue(volume, isovalue);
  run.scene.isovalue = isovalue;
  run.volume = volumeOf(volume, isovalue);
  const Plan plan = planFor(scene);
  const auto engine = stages.run("open Vulkan device", "computing on Vulkan", [&] {
    return std::make_unique<Engine>(volume, plan, isovalue, scene.gpu, scene.gpu_memory_bytes,
                                    passProgress(progress, stopIfInterrupted));
  });
  run.vulkan = {engine->gpu().name, engine->gpu().driver, engine->gpu().api_version};
  // The engine's own stages come out of the time that making it took; what is left opened the device.
  for (const StageTime& inner : engine->stages()) run.stages.back().seconds -= inner.seconds;
  run.stages.insert(run.stages.end(), engine->stages().begin(), engine->stages().end());
  // What is felt is what the engine made of the volume.
  std::optional<Volume> filtered;
  if (engine->filters()) filtered = engine->filtered(volume.facts());
  const Volume& felt = filtered ? *filtered : volume;
  const double felt_isovalue = engine->isovalue();
  const VolumeSurface surface(felt, felt_isovalue);

  const ScriptedPath path = stages.run("path", "building the path", [&] { return scriptedPath(scene, surface); });
  run.scene.duration_s = scene.path_file.empty() ? scene.duration_s : path.path.duration_s();
  checkRunLength(run.scene, availableMemoryBytes());
  if (!run.scene.press_depth_m) run.scene.press_depth_m = path.depth_m;
  if (!run.scene.slide_length_m) run.scene.slide_length_m = path.slide_m;
  if (!run.scene.approach_m) run.scene.approach_m = path.approach_m;
  run.phases = path.phases;
  run.notes = path.notes;
  run.notes.insert(run.notes.end(), objects.notes.begin(), objects.notes.end());
  const std::vector<std::string> start_notes = notesOnStart(objects, path.path.position(0));
  run.notes.insert(run.notes.end(), start_notes.begin(), start_notes.end());
  run.object_outlines = objects.outlines;

  AlgorithmSetup setup = algorithmSetup(scene, felt_isovalue, densityScale(felt, felt_isovalue), objects.objects);
  if (plan.meshes) {
    setup.isosurface = stages.run("isosurface mesh", "extracting the isosurface's mesh", [&] {
      return std::make_shared<const TriangleMesh>(isosurfaceMesh(felt, felt_isovalue));
    });
  }
  PlanFacts facts = engine->planFacts();
  if (setup.isosurface != nullptr) facts.mesh_triangles = setup.isosurface->triangles.size();
  run.plan = planWords(plan, facts);

  const double object_m3 = scene.edit.empty() ? 0 : objectVolume_m3(volume, isovalue);
  // With --save the edits own the volume while the servo runs: nothing below reads it before finish().
  std::unique_ptr<LiveEdits> edits;
  if (!scene.edit.empty()) {
    edits = stages.run("edit set-up", "making edits ready",
                       [&] { return std::make_unique<LiveEdits>(run.scene, volume, *engine); });
  }

  const auto begin = [&] {  // from the first tick on there is something that was felt
    kept.emplace();
    tellWhatIsKept(wordsOfSecondRequest(scene));
    progress.stage(fmt::format("palpating with {} on {}", scene.algorithm, engine->gpu().name));
  };
  LoopResult result = stages.run("servo", "making ready to palpate", [&] {
    LoopResult loop;
    const auto servo = [&] {
      loop = runServo(run.scene, std::move(setup), path.path, *engine, edits.get(), progress, begin);
    };
    edits ? edits->during(servo) : servo();
    return loop;
  });
  run.records = std::move(result.records);
  run.grid_points = result.ticks_run + result.ticks_skipped;
  endEarly(run);
  run.realtime = realTimeWords(scene, result);
  run.stability = assessContact(run.records, {.resolution_m = run.scene.encoder_resolution_m,
                                              .delay_ticks = run.scene.device_delay_ticks,
                                              .lacking_Ns_per_m = lackingDamping(run.scene),
                                              .path = &path.path});
  for (const auto& note : {noteOnSilence(run.records, felt_isovalue, run.scene.rate_hz, scene.algorithm),
                           noteOnEncoders(run.scene), noteOnTexture(run.scene)}) {
    if (note) run.notes.push_back(*note);
  }
  run.faults = faultsOf(run);
  if (std::none_of(run.records.begin(), run.records.end(), [](const TickRecord& r) { return r.in_contact; })) {
    run.notes.emplace_back(
        "nothing was touched: the path meets no surface; look at --start, --toward, --depth or --path");
  }
  run.exact = exactErrorsOf(run);
  if (edits) {
    if (!scene.save.empty()) progress.stage("saving " + scene.save);  // after Ctrl-C too
    run.edits = edits->finish(run.notes);                             // from here on the volume is this thread's again
    if (!run.ended_early.empty()) edits->dropEmptyJournal();          // so that the same command can be given again
    if (!engine->broken()) {  // for the picture; after a device error it shows what was there before
      engine->readBack(volume);
      run.edits->content = contentHash(volume);
      run.edits->added_m3 = objectVolume_m3(volume, isovalue) - object_m3;
      if (filtered) filtered = engine->filtered(volume.facts());
    }
  }

  const std::string picture = plan.draws ? pictureOf(run, surface, *engine, stages) : std::string();
  run.files = outputFiles(scene, folder, !picture.empty());
  if (run.edits && run.edits->saves > 0) run.files.push_back(scene.save);
  run.memory = engine->memory();
  run.memory.push_back({"volume on the CPU", volume.storedBytes()});
  run.memory.push_back(residentPeak());
  progress.stage("writing " + scene.out);
  writeOutputs(run, picture, folder);
  tellWhatIsKept("what was felt is in " + scene.out);
  progress.done();
  return run;
}

}  // namespace palpate
