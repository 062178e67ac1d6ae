// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/touch_job.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/load/stair_words.hpp"
#include "apps/report/html_report.hpp"
#include "apps/report/summary.hpp"
#include "apps/report/trace_csv.hpp"
#include "apps/report/words.hpp"
#include "apps/servo_setup/recording_file.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_objects.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/touch/device_ahead.hpp"
#include "apps/touch/exact_errors.hpp"
#include "apps/touch/force_error.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/touch/object_volume.hpp"
#include "apps/touch/output_folder.hpp"
#include "apps/touch/picture.hpp"
#include "apps/touch/plane_age.hpp"
#include "apps/touch/run_notes.hpp"
#include "apps/touch/scene_plan.hpp"
#include "apps/touch/scripted_path.hpp"
#include "apps/touch/servo_run.hpp"
#include "apps/touch/touch_servo.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/atomic_file.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/mapped_libraries.hpp"
#include "base/process_start.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/loop/contact_stability.hpp"
#include "servo/loop/real_time.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/velocity.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

void stopIfInterrupted() {
  throwIfInterrupted("palpate touch");
}

// Runs the stages of a job. Announces and times each; begins none after Ctrl-C.
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

// No result takes another's place.
void checkFilesDiffer(const Scene& scene) {
  for (const char* result : kRunResults)
    checkOutputsDiffer({scene.save, scene.record, std::filesystem::path(scene.out) / result});
}

// Finds errors of the command line before a volume is loaded.
void checkEarly(const Scene& scene, const ContactObjects& objects) {
  if (scene.volume.empty()) {
    throw Error(Error::Code::kBadInput, "palpate touch", "no volume is given",
                "name a file, a DICOM folder or a phantom, for example 'phantom:sphere?size=64'");
  }
  // An algorithm that touches a mesh can be made only from the volume's.
  if (!algorithmEntry(scene.algorithm).needs.isosurface_mesh) {
    (void)makeAlgorithm(rigSettings(scene, scene.isovalue.value_or(0.0)), {.objects = objects});
  }
  VelocityParameters velocity;
  velocity.name = scene.velocity;
  (void)VelocityEstimate(velocity, scene.rate_hz);
  checkEditOptions(scene);
  checkFilesDiffer(scene);
  checkDevice(scene);
  if (scene.require_real_time && !scene.simulated_clock) checkRealTime(LoopParameters{}.priority);
  if (scene.path_file.empty()) checkRunLength(scene, availableMemoryBytes());
}

// The phantom's exact surface lies at its own isovalue; at another one, where the tool may be on an object, and where
// it edits, nothing exact is known.
std::optional<ExactErrors> exactErrorsOf(const TouchRun& run) {
  if (!run.scene.volume.starts_with("phantom:") || !run.scene.objects.empty() || !run.scene.edit.empty())
    return std::nullopt;
  const std::unique_ptr<Phantom> phantom = makePhantom(run.scene.volume);
  if (phantom->isovalue() != run.volume.isovalue) return std::nullopt;
  return exactErrors(*phantom, run.records, run.phases, springStiffness(run.scene));
}

// Pictures and pages name a file without its folder; the command that repeats the run has its path.
std::string shownName(const VolumeFacts& facts) {
  if (facts.format == "phantom") return facts.source;
  const std::filesystem::path path(facts.source);
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

// No path leads a device that a person holds.
ScriptedPath restingPath(const Vec3& at_W) {
  return {.path = SampledPath({0}, {at_W}, SampledPath::Interpolation::kLinear), .phases = {}, .notes = {}};
}

double durationOf(const Scene& scene, const Path& path) {
  if (!hasPath(scene) && !isHeld(scene)) return recordedDuration_s(scene);
  return scene.path_file.empty() || isHeld(scene) ? scene.duration_s : path.duration_s();
}

RunVolume volumeOf(const Volume& volume, double isovalue) {
  return {shownName(volume.facts()), volume.facts().format, volume.size(), volume.lattice().spacing_m,
          volume.minimum(),          volume.maximum(),      isovalue};
}

std::vector<std::string> planWords(const std::vector<PlanLine>& lines) {
  std::vector<std::string> words;
  for (const PlanLine& line : lines) {
    std::string text = fmt::format("{}: {} ({})", line.done ? "done" : "left out", line.what, line.why);
    if (line.saved_bytes > 0) text += "; saves " + inMiB(line.saved_bytes);
    words.push_back(std::move(text));
  }
  return words;
}

std::vector<RunFault> faultsOf(const TouchRun& run) {
  std::vector<RunFault> faults;
  for (const FaultCount& count : run.figures->faults) {
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

std::vector<std::string> outputFiles(const TouchRun& run, const OutputFolder& folder, bool has_picture) {
  std::vector<std::string> files;
  if (has_picture) files.push_back(folder.file("view.png").string());
  files.push_back(folder.file("report.html").string());
  files.push_back(folder.file("summary.json").string());
  if (writesTrace(run)) files.push_back(folder.file("trace.csv").string());
  if (run.edits && run.edits->saves > 0) files.push_back(run.scene.save);
  if (!run.scene.record.empty()) files.push_back(run.scene.record);
  return files;
}

// The error of a run that is stopped while its results are written.
std::string wordsOfSecondRequest(const std::string& journal, const std::string& save) {
  std::string places = journal;
  if (!save.empty()) places += (places.empty() ? "" : " and ") + save;
  return places.empty() ? "nothing was written; start it again"
                        : "no report was written; what was saved of the edits is in " + places;
}

// A tick that the tool did not reach has no phase.
void endPhases(std::vector<PathPhase>& phases, double end_s) {
  std::erase_if(phases, [&](const PathPhase& phase) { return phase.begin_s >= end_s; });
  for (PathPhase& phase : phases) phase.end_s = std::min(phase.end_s, end_s);
}

// The run is told as one that was stopped, and how to get what it then leaves out.
void endWith(TouchRun& run, const std::string& why) {
  run.ended_early = why;
  if (!run.scene.trace || writesTrace(run)) return;
  const std::size_t ticks = run.records.size();
  run.ended_early += fmt::format(", without trace.csv (--stopped-trace {} writes it for so many ticks)", ticks);
}

// Where the user stopped the servo before its time: what was felt until then is told like any run. Throws
// Error(kCancelled) where nothing was.
void endEarly(TouchRun& run) {
  const double wanted = std::round(run.scene.duration_s * run.scene.rate_hz);
  if (!interrupted()) return;
  if (run.records.empty()) stopIfInterrupted();
  const double felt_s = static_cast<double>(run.records.back().tick + 1) / run.scene.rate_hz;
  if (static_cast<double>(run.records.back().tick + 1) >= wanted) return;
  endWith(run, fmt::format("stopped by the user after {} s of {} s", shortNumber(felt_s),
                           shortNumber(run.scene.duration_s)));
  endPhases(run.phases, felt_s);
}

// If the user stops the program meanwhile, a long trace is given up; the other results are written.
void writeTrace(TouchRun& run, OutputFolder& folder) {
  const bool is_long = run.records.size() > static_cast<std::size_t>(run.scene.stopped_trace_ticks);
  try {
    if (writesTrace(run)) {
      folder.write("trace.csv", [&](const std::filesystem::path& draft) {
        writeTraceCsv(draft, run.records, run.ended_early, [&] {
          if (is_long) stopIfInterrupted();
        });
      });
    }
  } catch (const Error& error) {
    if (error.code() != Error::Code::kCancelled) throw;
    endWith(run, "stopped by the user after the run");
  }
  if (!writesTrace(run)) folder.leaveOut("trace.csv");
}

// Writes everything or nothing; `picture` may be empty.
void writeOutputs(TouchRun& run, const std::string& picture, OutputFolder& folder) {
  writeTrace(run, folder);  // the files below say whether it was written
  run.files = outputFiles(run, folder, !picture.empty());
  if (picture.empty()) {
    folder.leaveOut("view.png");
  } else {
    folder.write("view.png", [&](const std::filesystem::path& draft) { writeFileAtomically(draft, picture); });
  }
  folder.write("report.html", [&](const std::filesystem::path& draft) { writeReport(draft, run, picture); });
  folder.write("summary.json", [&](const std::filesystem::path& draft) { writeSummary(draft, run); });
  refuseForeignResults(run.scene.out);  // files that appeared since the start
  folder.publish("summary.json");       // first: by it the next run knows that it may replace the others
}

// Tells a user who has pressed Ctrl-C why the program goes on.
std::string wordsOfStopping(const TouchRun& run) {
  return fmt::format("stopping: writing the report of {} ticks; Ctrl-C again gives it up", run.records.size());
}

// A run in three steps. Members hold what a later step needs.
class TouchJob {
 public:
  // Throws for errors of the command line, before any long work.
  TouchJob(const Scene& scene, const std::string& command, const std::string& commit, Progress& progress)
      : scene_(scene), progress_(progress), objects_(makeSceneObjects(scene.objects)), stages_(progress, run_.stages) {
    checkEarly(scene, objects_.objects);
    refuseForeignResults(scene.out);
    folder_.emplace(scene.out);
    run_.scene = scene;
    run_.machine = readMachineFacts();
    run_.commit = commit;
    run_.command = command;
  }

  void prepare() {
    load();
    compute();
    layPath();
    readyAlgorithm();
    readyEdits();
    readyServo();  // last: a device that is held is not left waiting
  }
  void feel();
  TouchRun tell();

 private:
  void load();
  void compute();
  void layPath();
  void warn(const std::string& warning);
  void readyAlgorithm();
  void readyServo();
  void readyEdits();
  void assess();
  void finishEdits();
  [[nodiscard]] std::string picture();
  // The tool feels the engine's field, which may be filtered.
  [[nodiscard]] const Volume& felt() const { return filtered_ ? *filtered_ : *volume_; }

  std::optional<KeptWork> kept_;  // first, so that it outlives the members that take long to free
  const Scene& scene_;
  Progress& progress_;
  SceneObjects objects_;
  std::optional<OutputFolder> folder_;
  TouchRun run_;
  Stages stages_;
  std::optional<DeviceAhead> ahead_;
  std::optional<Volume> volume_;
  double isovalue_ = 0;  // of the volume
  VolumeBox box_;
  Plan plan_;
  TouchServo servo_;  // outlives the engine, which may write to its memory
  std::unique_ptr<Engine> engine_;
  std::optional<Volume> filtered_;
  std::optional<VolumeSurface> surface_;  // of what is felt
  std::optional<ScriptedPath> path_;
  DeviceLimits limits_;
  double most_damping_Ns_per_m_ = std::numeric_limits<double>::infinity();
  RigVolume rig_volume_;
  double object_m3_ = 0;  // before the edits
  // With --save they own the volume while the servo runs: nobody else reads it before finish().
  std::unique_ptr<LiveEdits> edits_;
};

void TouchJob::load() {
  ahead_.emplace(scene_.volume, scene_.gpu);
  volume_ = stages_.run("load", "loading " + scene_.volume, [&] { return loadAndTell(scene_.volume, progress_); });
  checkTouchable(*volume_);
  // Rounded to float as on the GPU, since servo and kernels must agree on what is object.
  isovalue_ = static_cast<float>(scene_.isovalue ? *scene_.isovalue : defaultIsovalue(*volume_));
  checkIsovalue(*volume_, isovalue_);
  run_.scene.isovalue = isovalue_;
  run_.scene.stiffness_N_per_m = stiffnessOf(scene_);
  run_.scene.damping_Ns_per_m = dampingOf(scene_);
  run_.volume = volumeOf(*volume_, isovalue_);
  box_ = boxOf(volume_->lattice(), volume_->size());
}

void TouchJob::compute() {
  plan_ = planFor(scene_);
  engine_ = stages_.run("open Vulkan device", "computing on Vulkan", [&] {
    return std::make_unique<Engine>(*volume_, plan_, isovalue_, scene_.gpu, scene_.gpu_memory_bytes,
                                    passProgress(progress_, stopIfInterrupted));
  });
  ahead_.reset();
  run_.vulkan = {engine_->gpu().name, engine_->gpu().driver, engine_->gpu().api_version};
  // The time of the constructor without the engine's own stages is that of opening the device.
  for (const StageTime& inner : engine_->stages()) run_.stages.back().seconds -= inner.seconds;
  run_.stages.insert(run_.stages.end(), engine_->stages().begin(), engine_->stages().end());
  if (engine_->filters()) filtered_ = engine_->filtered(volume_->facts());
  surface_.emplace(felt(), engine_->isovalue());
}

void TouchJob::layPath() {
  path_ = stages_.run("path", "building the path", [&] {
    if (!hasPath(scene_)) return restingPath(box_.middle_W);
    return scriptedPath(scene_, *surface_);
  });
  run_.scene.duration_s = durationOf(scene_, path_->path);
  checkRunLength(run_.scene, availableMemoryBytes());
  if (!run_.scene.press_depth_m) run_.scene.press_depth_m = path_->depth_m;
  if (!run_.scene.slide_length_m) run_.scene.slide_length_m = path_->slide_m;
  if (!run_.scene.approach_m) run_.scene.approach_m = path_->approach_m;
  run_.phases = path_->phases;
  run_.notes = path_->notes;
  run_.notes.insert(run_.notes.end(), objects_.notes.begin(), objects_.notes.end());
  const std::vector<std::string> start_notes = notesOnStart(objects_, path_->path.position(0));
  run_.notes.insert(run_.notes.end(), start_notes.begin(), start_notes.end());
  run_.object_outlines = objects_.outlines;
  if (const auto stairs = stairWords(*volume_, isovalue_, plan_, FilterGiven::kAsOption); !stairs.empty())
    warn(run_.volume.name + ": " + stairs);
  if (const auto note = noteOnRecording(run_.scene)) warn(*note);
  if (!hasPath(scene_)) return;
  if (const auto note = noteOnPlaneAge(run_.scene, path_->path, *surface_)) warn(*note);
}

// Told at once, and kept for the report.
void TouchJob::warn(const std::string& warning) {
  tellUser(warning);
  run_.notes.push_back(warning);
}

void TouchJob::readyAlgorithm() {
  const double isovalue = engine_->isovalue();
  rig_volume_ = {.scale = densityScaleOf(felt(), isovalue), .objects = objects_.objects};
  std::size_t triangles = 0;
  if (algorithmEntry(scene_.algorithm).needs.isosurface_mesh) {
    rig_volume_.isosurface = stages_.run("isosurface mesh", "extracting the isosurface's mesh", [&] {
      TriangleMesh mesh = isosurfaceMesh(felt(), isovalue);
      triangles = mesh.triangles.size();
      return std::make_shared<const MeshObject>(std::move(mesh), "isosurface");
    });
  }
  run_.plan = planWords(scenePlanLines(scene_, plan_, engine_->planFacts(), triangles));
}

void TouchJob::readyServo() {
  servo_.make(run_.scene,
              {.path = path_->path, .box = box_, .isovalue = isovalue_, .asked = scene_, .commit = run_.commit},
              *engine_);
  run_.scene.stiffness_N_per_m = servo_.contact().stiffness_N_per_m;
  run_.scene.damping_Ns_per_m = servo_.contact().damping_Ns_per_m;
  for (const std::string& warning : servo_.warnings()) warn(warning);
}

void TouchJob::readyEdits() {
  if (scene_.edit.empty()) return;
  object_m3_ = objectVolume_m3(*volume_, isovalue_);
  edits_ = stages_.run("edit set-up", "making edits ready",
                       [&] { return std::make_unique<LiveEdits>(run_.scene, *volume_, *engine_); });
}

void TouchJob::feel() {
  const auto begin =
      [&](const std::vector<std::string>& warnings) {  // from the first tick on there are results to keep
        kept_.emplace();
        for (const std::string& warning : warnings) warn(warning);
        tellWhatIsKept(wordsOfSecondRequest(scene_.journal, scene_.save));
        progress_.stage(fmt::format("palpating with {} on {}", scene_.algorithm, engine_->gpu().name));
      };
  ServoRun felt = stages_.run("servo", "making ready to palpate", [&] {
    ServoRun run;
    const auto servo = [&] {
      RigEdits* const edits = edits_ ? &edits_->edits() : nullptr;
      run = servo_.run(run_.scene, std::move(rig_volume_), *engine_, edits, progress_, begin);
    };
    edits_ ? edits_->during(servo) : servo();
    return run;
  });
  run_.loop_us_a_tick = felt.loop_us_a_tick;
  run_.work.threads = std::move(felt.threads);
  most_damping_Ns_per_m_ = felt.most_damping_Ns_per_m;
  LoopResult& result = felt.loop;
  run_.records = std::move(result.records);
  limits_ = result.device;
  run_.grid_points = result.ticks_run + result.ticks_skipped;
  run_.start_to_first_tick_s = static_cast<double>(result.first_due_ns - processStart_ns()) / kNanosecondsPerSecond;
  run_.realtime = realTimeWords(scene_, result);
  run_.device = servo_.letGo();
  endEarly(run_);
  if (!run_.ended_early.empty()) progress_.stage(wordsOfStopping(run_));
}

void TouchJob::assess() {
  run_.figures = figuresOf(run_);
  run_.stability = assessContact(run_.records, {.resolution_m = limits_.position_resolution_m,
                                                .delay_ticks = limits_.force_delay_ticks,
                                                .lacking_Ns_per_m = lackingDamping(run_.scene, limits_),
                                                .damping_Ns_per_m = dampingOf(run_.scene),
                                                .most_damping_Ns_per_m = most_damping_Ns_per_m_,
                                                .path = hasPath(scene_) ? &path_->path : nullptr});
  run_.faults = faultsOf(run_);
  run_.exact = exactErrorsOf(run_);
  Scene asked = scene_;  // with the way that was asked for, not the one that was chosen
  asked.stiffness_N_per_m = run_.scene.stiffness_N_per_m;
  asked.damping_Ns_per_m = run_.scene.damping_Ns_per_m;
  for (const auto& note :
       {noteOnSilence(run_.records, engine_->isovalue(), run_.scene.rate_hz, scene_.algorithm),
        noteOnEncoders(run_.scene, limits_), noteOnTexture(run_.scene), noteOnFaintForce(asked, *run_.figures),
        noteOnNoContact(*run_.figures, !run_.ended_early.empty(), hasPath(scene_)),
        noteOnHand(scene_, *run_.figures, run_.phases), noteOnBrush(run_.scene, *run_.figures)}) {
    if (note) run_.notes.push_back(*note);
  }
}

void TouchJob::finishEdits() {
  if (!edits_) return;
  if (!scene_.save.empty()) progress_.stage("saving " + scene_.save);  // after Ctrl-C too
  run_.edits = edits_->finish(run_.notes);                             // now the volume belongs to this thread again
  if (!run_.ended_early.empty()) {
    progress_.stage(wordsOfStopping(run_));
    edits_->dropEmptyJournal(*run_.edits);  // so that the same command can be run again
    if (run_.edits->journal_bytes == 0) tellWhatIsKept(wordsOfSecondRequest("", scene_.save));
  }
  if (engine_->broken()) return;  // the picture shows the volume as last read back
  engine_->readBack(*volume_);
  run_.edits->content = contentHash(*volume_);
  run_.edits->added_m3 = objectVolume_m3(*volume_, isovalue_) - object_m3_;
  if (filtered_) filtered_ = engine_->filtered(volume_->facts());
}

// Empty if the plan has no picture, or if the user stops it.
std::string TouchJob::picture() {
  if (!plan_.request.draws) return {};
  try {
    return stages_.run("picture", "drawing", [&] { return drawPicture(run_, *surface_, *engine_, stopIfInterrupted); });
  } catch (const Error& error) {
    if (error.code() != Error::Code::kCancelled) throw;
  }
  if (run_.ended_early.empty()) endWith(run_, "stopped by the user after the run, before the picture");
  return {};
}

TouchRun TouchJob::tell() {
  if (run_.ended_early.empty()) progress_.stage("assessing what was felt");
  assess();
  finishEdits();
  const std::string view = picture();
  run_.memory = engine_->memory();
  run_.memory.push_back({"volume on the CPU", volume_->storedBytes()});
  run_.memory.push_back(residentPeak());
  run_.work.gpu = engine_->gpuUse();
  run_.libraries = mappedLibraries();
  if (run_.ended_early.empty()) progress_.stage("writing " + scene_.out);
  writeOutputs(run_, view, *folder_);
  // Last: a full disk then leaves the report.
  if (servo_.recording()) saveRecording(scene_.record, *servo_.recording());
  tellWhatIsKept("what was felt is in " + scene_.out);
  progress_.done();
  return std::move(run_);
}

}  // namespace

TouchRun runTouchJob(const Scene& scene, const std::string& command, const std::string& commit, Progress& progress) {
  const Scene edited = withRecordedBrush(scene);
  TouchJob job(edited, command, commit, progress);
  job.prepare();
  job.feel();
  return job.tell();
}

}  // namespace palpate
