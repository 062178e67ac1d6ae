// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/served_volume.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "apps/held/held_device.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/touch/scene_plan.hpp"
#include "apps/touch/scripted_path.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/thread_names.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr int kPatience_ms = 10'000;  // with a servo that makes its device; nobody's edit is made meanwhile
constexpr std::chrono::milliseconds kIdle{1};
constexpr std::chrono::milliseconds kRigLook{2};

void checkServable(const Scene& scene) {
  if (scene.simulated_clock)
    refuse("--clock simulated", "a service runs by the real clock", "leave it out, or take 'palpate touch'");
  if (!hasPath(scene) && !isHeld(scene))
    refuse("--device recorded", "a service plays no recording back", "take 'palpate touch' for that");
  if (!scene.edit.empty())
    refuse("--edit " + scene.edit, "a service edits what its clients ask for",
           "leave it out, and take 'palpate ctl edit'");
  if (algorithmEntry(scene.algorithm).needs.isosurface_mesh) {
    refuse("--algorithm " + scene.algorithm, "it touches a mesh, which would not follow the edits",
           "choose another one, as hri");
  }
}

Plan planOf(Scene scene) {
  scene.picture = true;
  EngineRequest request = planFor(scene).request;
  request.edits = request.draws = true;
  request.other_isovalues = !scene.gradient_all && scene.samples != "half" && scene.field != "distance";
  return makePlan(request);
}

}  // namespace

ServedVolume::ServedVolume(const Request& request, Progress& progress, Tell tell)
    : commit_(request.commit), tell_(std::move(tell)), scene_(request.scene) {
  checkServable(scene_);
  journal_.emplace(request.journal);
  try {
    live_.emplace(LiveVolumeRequest{.volume = scene_.volume,
                                    .isovalue = scene_.isovalue,
                                    .gpu = scene_.gpu,
                                    .gpu_memory_bytes = scene_.gpu_memory_bytes,
                                    .plan = planOf(scene_),
                                    .journal = request.journal,
                                    .recovers = journal_->earlier(),
                                    .work = "palpate serve"},
                  progress, tell_);
  } catch (const Error& error) {
    if (journal_->earlier().empty() || error.code() != Error::Code::kBadInput) throw;
    throw Error(
        error.code(), error.input(), error.reason(),
        fmt::format("edits of an earlier service wait in {0}: serve their volume again, or write them to a file "
                    "with 'palpate recover {0} --out FILE' and delete that folder, or name another --journal",
                    journal_->earlier().string()));
  }
  if (live_->journalFailure().empty()) journal_->takeOver();
  const Volume& volume = live_->volume();
  scene_.isovalue = live_->firstIsovalue();
  scene_.stiffness_N_per_m = stiffnessOf(scene_);
  scene_.damping_Ns_per_m = dampingOf(scene_);
  size_ = volume.size();
  lattice_ = volume.lattice();
  box_ = boxOf(lattice_, size_);
  Engine& engine = live_->engine();
  scale_ = engine.filters() ? densityScaleOf(engine.filtered(volume.facts()), engine.isovalue())
                            : densityScaleOf(volume, engine.isovalue());
  seen_ = objectExtent(engine.bounds(), BrickGrid{size_, lattice_.spacing_m}, lattice_,
                       static_cast<float>(engine.isovalue()), {}, engine.filters() ? nullptr : &volume);
  if (hasPath(scene_)) way_ = scriptedPath(scene_, VolumeSurface(volume, live_->firstIsovalue())).path;
  other_isovalues_ = planOf(request.scene).request.other_isovalues;
  gradient_everywhere_ = engine.gradientEverywhere();
  lowest_ = volume.minimum();
  highest_ = volume.maximum();
  noteStatus();
}

ServedVolume::~ServedVolume() {
  try {
    close();
  } catch (const std::exception&) {  // nobody is left who could be told
  }
}

void ServedVolume::start() {
  thread_ = std::jthread([this] { run(); });
}

void ServedVolume::close() {
  if (std::exchange(closed_, true)) return;
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  // A file that was written beside is a copy: the next start begins from the volume again, and makes the edits again.
  live_->edits().doWaiting(0);
  const bool has_edits = live_->edits().counts().done > 0;
  live_->close(has_edits || failure_ != nullptr ? LiveVolume::KeepJournal::kAlways : LiveVolume::KeepJournal::kNever);
  settle();
  if (failure_) std::rethrow_exception(failure_);
  if (has_edits && live_->keepsJournal()) tell_("its edits are in the journal, and come back with the next start");
}

void ServedVolume::run() {
  nameThisThread("engine");
  try {
    while (!stop_) {
      wire::HelloT hello;
      if (Channel next = takeNext(hello); next.open()) {
        try {
          feel(std::move(next), hello);
        } catch (const std::exception& error) {
          if (!live_->edits().counts().editing || live_->engine().broken()) throw;
          if (std::exchange(servos_trouble_, error.what()) != error.what()) tell_(error.what());
        }
        if (servo_) servo_->leave();
        const std::lock_guard lock(mutex_);
        has_servo_ = status_.servo = false;
      } else {
        lookAlone();
      }
      if (!live_->edits().counts().editing)
        throw Error(Error::Code::kDevice, "the engine", "its device has failed, and nothing more can be edited",
                    "start it again: the edits come back from the journal");
    }
  } catch (...) {
    failure_ = std::current_exception();
    failed_.store(true, std::memory_order_release);
  }
}

Channel ServedVolume::takeNext(wire::HelloT& hello) {
  const std::lock_guard lock(mutex_);
  hello = hello_;
  return std::exchange(next_, Channel());
}

bool ServedVolume::attach(Channel channel, const wire::HelloT& hello) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(has_servo_, true)) return false;
  hello_ = hello;
  next_ = std::move(channel);
  return true;
}

RigSettings ServedVolume::firstSettings() const {
  RigSettings settings = rigSettings(scene(), live_->engine().isovalue());
  settings.parameters.isovalue = live_->engine().isovalue();
  return settings;
}

// As long as the servo is there.
void ServedVolume::feel(Channel channel, const wire::HelloT& hello) {
  Engine& engine = live_->engine();
  auto servo =
      std::make_unique<RemoteServo>(std::move(channel), RemoteServo::Request{.scene = scene(),
                                                                             .box = box_,
                                                                             .way = way_ ? &*way_ : nullptr,
                                                                             .window_samples = engine.windowCapacity(),
                                                                             .commit = commit_,
                                                                             .hello = &hello,
                                                                             .patience_ms = kPatience_ms});
  LinkMemory& memory = servo->memory();
  engine.shareWindows({.block = &memory.windows(),
                       .samples = memory.samples(),
                       .capacity = memory.capacity(),
                       .bytes = memory.windowBytes(),
                       .first_version = servo->firstVersion()});
  servo_ = std::move(servo);  // only now may the former one's memory go
  LoopParameters loop = loopParameters(scene());
  loop.ticks = 0;
  loop.record_ticks = 1;
  TouchRig rig(engine, *servo_, loop, RigVolume{.scale = scale_}, firstSettings(), &live_->edits());
  rig.drawFor(view_);
  const std::uint64_t first = servo_->firstVersion();
  rig.start([this, first](const ToolPose& pose, std::int64_t now_ns) {
    {
      const std::lock_guard lock(mutex_);
      if (pose.tick != status_.pose.tick) status_.pose_at_ns = now_ns;
      status_.pose = pose;
      status_.windows = pose.window_version >= first ? pose.window_version - first + 1 : 0;
    }
    static_cast<void>(lookAround(now_ns));
  });
  struct Lent {
    ServedVolume& served;
    ~Lent() { served.lendRig(nullptr); }
  } const lent{*this};
  lendRig(&rig);
  {
    const std::lock_guard lock(mutex_);
    status_.servo = true;
    ++status_.servos;
    status_.device = std::string(servo_->device().name());
  }
  servos_trouble_.clear();
  tell_(fmt::format("a servo with the device '{}' touches {}", servo_->device().name(), live_->name()));
  while (rig.running() && !stop_ && live_->edits().counts().editing) {
    heedRefusal(rig);
    std::this_thread::sleep_for(kRigLook);
  }
  lendRig(nullptr);
  rig.requestStop();
  static_cast<void>(rig.wait());
}

// Settings that changed since the rig was made are the servo's from now on.
void ServedVolume::lendRig(TouchRig* rig) {
  const std::lock_guard order(changers_);
  if (rig != nullptr) rig->change(rigSettings(scene(), wantedIsovalue(scene())));
  rig_ = rig;
}

// The isovalue that the engine refused is not asked for again.
void ServedVolume::heedRefusal(TouchRig& rig) {
  const std::optional<Error> refusal = rig.takeRefusal();
  if (!refusal) return;
  tell_(refusal->what());
  const std::lock_guard lock(mutex_);
  scene_.isovalue = rig.settings().parameters.isovalue;
}

double ServedVolume::wantedIsovalue(const Scene& scene) const {
  return scene.field == "distance" ? live_->engine().isovalue() : scene.isovalue.value_or(live_->firstIsovalue());
}

void ServedVolume::lookAlone() {
  const std::int64_t now_ns = monotonicNow_ns();
  live_->edits().look(ToolPose{}, now_ns);
  const bool draws = view_.look(live_->engine(), now_ns);
  const bool busy = lookAround(now_ns) || draws;
  if (!busy) std::this_thread::sleep_for(kIdle);
}

// What is to be done at every look beside edits and windows. Whether more is to be drawn.
bool ServedVolume::lookAround(std::int64_t) {
  settle();
  const bool draws = drawOn();
  noteStatus();
  return draws;
}

void ServedVolume::noteStatus() {
  const RigEdits::Counts edits = live_->edits().counts();
  const JournalWriter* const journal = live_->session().journal();
  const std::lock_guard lock(mutex_);
  status_.waiting = written_.size();
  status_.content_version = edits.content_version;
  status_.edits = edits.edits;
  status_.refused = edits.refused;
  status_.undoable = edits.done;
  status_.redoable = edits.undone;
  status_.unsaved = live_->isUnsaved();
  status_.journal_bytes = journal != nullptr ? journal->bytes() : 0;
  if (journal != nullptr && journal->failed()) status_.journal_failure = journal->failure();
}

ServedStatus ServedVolume::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

// Called by the engine's thread, once the edit is made or refused.
ServedVolume::Done ServedVolume::onDisk(Done done) {
  return [this, done = std::move(done)](const std::optional<Error>& refusal) {
    const JournalWriter* const journal = live_->session().journal();
    if (refusal || journal == nullptr) return done(refusal);
    written_.push_back({journal->appended(), done});
  };
}

void ServedVolume::settle() {
  const JournalWriter* const journal = live_->session().journal();
  if (journal == nullptr) return;
  const bool failed = journal->failed();
  for (; !written_.empty(); written_.pop_front()) {
    if (written_.front().record <= journal->acknowledged()) {
      written_.front().done({});
    } else if (failed) {
      written_.front().done(Error(Error::Code::kIo, "the journal",
                                  "the edit was made, but it is not on the disk: " + journal->failure(),
                                  "save the volume with 'palpate ctl save'"));
    } else {
      return;
    }
  }
}

void ServedVolume::edit(std::vector<EditCommand> commands, Done done) {
  static_cast<void>(live_->edits().edit(std::move(commands), onDisk(std::move(done))));
}
void ServedVolume::undo(Done done) {
  static_cast<void>(live_->edits().undo(onDisk(std::move(done))));
}
void ServedVolume::redo(Done done) {
  static_cast<void>(live_->edits().redo(onDisk(std::move(done))));
}
void ServedVolume::save(const std::string& file, std::function<void(const LiveVolume::Saved&)> done) {
  live_->save(file, scene().isovalue.value_or(live_->firstIsovalue()), std::move(done));
}

void ServedVolume::render(int width, int height, std::function<void(RenderedImage, const std::string& failure)> done) {
  RenderRequest request;
  request.width = width;
  request.height = height;
  const double distance_m = fittingDistance(request, seen_);
  ViewRequest view{.camera = frameCamera(request, seen_.middle_W, distance_m, 0), .style = {}};
  constexpr std::size_t kMostDrawings = 16;
  const std::lock_guard lock(mutex_);
  if (drawings_.size() >= kMostDrawings)
    throw Error(Error::Code::kOutOfMemory, "the picture", "too many others wait", "ask again when they are done");
  drawings_.push_back({std::move(view), std::move(done)});
}

// Whether a picture is under way.
bool ServedVolume::drawOn() {
  if (!drawing_) {
    std::unique_lock lock(mutex_);
    if (drawings_.empty()) return false;
    drawing_ = std::move(drawings_.front());
    drawings_.pop_front();
    lock.unlock();
    view_.show(drawing_->request);
    drawing_from_ = live_->engine().editVersion();
    return true;
  }
  const std::string failure = view_.failure();
  const ViewFrame& frame = view_.latest();
  const bool is_whole = frame.whole && frame.edit_version >= drawing_from_ && frame.camera == drawing_->request.camera;
  if (!is_whole && failure.empty()) return true;
  std::exchange(drawing_, std::nullopt)
      ->done(is_whole ? live_->engine().picture() : RenderedImage{}, is_whole ? "" : failure);
  return true;
}

Scene ServedVolume::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
}

void ServedVolume::change(const Scene& scene) {
  if (algorithmEntry(scene.algorithm).needs.isosurface_mesh)
    refuse("servo.algorithm = " + scene.algorithm, "it touches a mesh, which would not follow the edits",
           "choose another one, as hri");
  const double isovalue = wantedIsovalue(scene);
  if (scene.isovalue != this->scene().isovalue) {
    if (!other_isovalues_)
      refuse("isovalue", "what is on the device serves the first one alone", "change it in the scene and start again");
    if (!(isovalue >= lowest_ && isovalue < highest_))
      refuse(fmt::format("isovalue {:g}", isovalue), fmt::format("the densities are {:g} to {:g}", lowest_, highest_),
             "choose one between them");
  }
  if (algorithmEntry(scene.algorithm).needs.gradient_everywhere && !gradient_everywhere_) {
    refuse("servo.algorithm = " + scene.algorithm,
           "it reads gradients everywhere, and those on the device lie around the isosurface",
           "start the service with --gradient all");
  }
  static_cast<void>(makeAlgorithm(rigSettings(scene, isovalue), RigVolume{.scale = scale_}));  // or says why not
  const std::lock_guard order(changers_);
  if (rig_ != nullptr) rig_->change(rigSettings(scene, isovalue));
  const std::lock_guard lock(mutex_);
  scene_ = scene;
}

}  // namespace palpate
