// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/served_volume.hpp"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "apps/convert/convert_job.hpp"
#include "apps/held/held_device.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/rig/remote_windows.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/touch/scripted_path.hpp"
#include "apps/touch/volume_surface.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/thread_names.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kFirstTick_ns = 5'000'000'000;
constexpr std::chrono::milliseconds kIdle{1};
constexpr std::chrono::milliseconds kRigLook{2};
constexpr std::int64_t kMemoryLook_ns = 500'000'000;

Error tooManyWait(const char* what) {
  return {Error::Code::kOutOfMemory, what, "too many edits wait, or editing has ended",
          "ask again when others are done"};
}

Error hasEnded() {
  return {Error::Code::kCancelled, "the engine", "it has ended", "start the service again, and ask again"};
}

}  // namespace

ServedVolume::ServedVolume(const Request& request, Progress& progress, Tell tell)
    : tell_(std::move(tell)), journal_(request.journal), first_scene_(request.scene) {
  checkServable(first_scene_);
  Scene filtered = first_scene_;
  filtered.filter = request.settings.filter;
  engine_ = std::make_unique<ServedEngine>(filtered, journal_, progress, tell_,
                                           [this](const Volume& volume, double isovalue) {
                                             if (hasPath(first_scene_))
                                               way_ = scriptedPath(first_scene_, VolumeSurface(volume, isovalue)).path;
                                             seen_volume_.statistics = statisticsOf(volume);
                                           });
  LiveVolume& live = engine_->live();
  first_isovalue_ = felt_isovalue_ = live.firstIsovalue();
  size_ = engine_->size();
  lattice_ = engine_->lattice();
  profile_ = live.engine().profile();
  seen_volume_ = {first_scene_.volume, size_, lattice_, seen_volume_.statistics, engine_->seen()};
  door_.emplace(ServoDoor::Ours{.scene = first_scene_,
                                .box = boxOf(lattice_, size_),
                                .way = way_ ? &*way_ : nullptr,
                                .told_ticks = kOnlookRoom.ticks,
                                .window_samples = live.engine().windowCapacity(),
                                .commit = request.commit},
                tell_);
  takeSettings(request.settings);
  noteMemory(monotonicNow_ns());
}

ServedVolume::~ServedVolume() {
  try {
    close();
  } catch (const std::exception&) {  // nobody is left who could be told
  }
}

bool ServedVolume::isAlive(std::int64_t within_ns) const noexcept {
  return monotonicNow_ns() - looked_at_ns_.load(std::memory_order_relaxed) < within_ns;
}

void ServedVolume::start() {
  looked_at_ns_ = monotonicNow_ns();
  thread_ = std::jthread([this] { run(); });
}

void ServedVolume::close(const std::string& save) {
  if (std::exchange(closed_, true)) return;
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  door_->close();
  refuseWaiting();
  const auto unsaved = std::make_shared<std::optional<Error>>();  // why the file was not written
  if (engine_) {
    // A file that was written beside is a copy: the next start begins from the volume again, and makes the edits again.
    LiveVolume& live = engine_->live();
    try {
      if (live.hasEngine()) live.edits().doWaiting(0);
    } catch (const std::exception&) {  // all that follows must be done: who asked is told by it
      if (!failure_) failure_ = std::current_exception();
    }
    const RigEdits::Counts counts = live.edits().counts();
    const bool has_edits = counts.done + counts.forgotten > 0;
    if (has_edits && !save.empty() && !failure_) {
      try {
        this->save(save, [this, unsaved](const LiveVolume::Saved& saved) {
          if (saved.written) tell_(saved.words);
          *unsaved = saved.refusal;
        });
      } catch (const Error& error) {
        *unsaved = error;
      }
    }
    struct Settled {  // whatever becomes of the rest: who asked is told
      ServedVolume& served;
      ~Settled() {
        try {
          served.settle();
        } catch (const std::exception&) {  // nobody is left who could be told
        }
      }
    } const settled{*this};
    live.close(has_edits || failure_ != nullptr ? LiveVolume::KeepJournal::kAlways : LiveVolume::KeepJournal::kNever);
    if (!failure_ && has_edits && live.keepsJournal())
      tell_("its edits are in the journal, and come back with the next start");
  }
  if (failure_) std::rethrow_exception(failure_);
  if (*unsaved)
    throw Error(Error::Code::kIo, save, "it was not written: " + (*unsaved)->reason(),
                (*unsaved)->remedy() + (keepsJournal() ? "; the edits are in the journal" : ""));
}

// What no engine will do any more.
void ServedVolume::refuseWaiting() {
  Done filter_done;
  {
    const std::lock_guard lock(mutex_);
    filter_done.swap(filter_done_);
  }
  if (filter_done) filter_done(hasEnded());
  asked_isovalues_.refuse(hasEnded());
  pictures_.giveUp(hasEnded().what());
}

void ServedVolume::run() {
  nameThisThread("engine");
  try {
    while (!stop_) {
      work();
      if (!stop_) makeAnew();
    }
  } catch (...) {
    failure_ = std::current_exception();
    failed_.store(true, std::memory_order_release);
  }
}

// Until the end, or the engine must be made anew.
void ServedVolume::work() {
  while (!stop_ && !mustBeMadeAnew()) {
    std::unique_ptr<RemoteServo> next = monotonicNow_ns() < next_servo_ns_ ? nullptr : door_->takeNext();
    const bool is_felt = next != nullptr;
    try {
      next ? feel(std::move(next)) : lookAlone();
    } catch (const std::exception& error) {
      mustBeMadeAnew() ? tell_(error.what()) : door_->tellTrouble(error.what());
    }
    if (!is_felt) continue;
    if (servo_) servo_->leave();
    {
      const std::lock_guard lock(mutex_);
      status_.servo = false;
    }
    door_->hasLeft();
  }
}

// As long as the servo is there.
void ServedVolume::feel(std::unique_ptr<RemoteServo> next) {
  LiveVolume& live = engine_->live();
  Engine& engine = live.engine();
  publishTo(*next, engine);
  servo_ = std::move(next);  // only now may the former one's memory go
  {
    const std::lock_guard lock(mutex_);
    status_.servo = true;
    status_.servo_process = servo_->process();
    ++status_.servos;
  }
  LoopParameters loop = loopParameters(scene());
  loop.ticks = 0;
  loop.record_ticks = 1;
  RigSettings first = rigSettings(scene(), engine.isovalue());
  first.parameters.isovalue = engine.isovalue();
  std::atomic<bool> is_broken{false};  // the engine, which a picture can have met while nothing is edited
  // While the rig waits for the servo's answers no edit is made. So after a failure no servo is taken in for as long as
  // that wait took.
  const std::int64_t from_ns = monotonicNow_ns();
  std::optional<TouchRig> made;
  try {
    made.emplace(engine, *servo_, loop, RigVolume{.scale = engine_->scale()}, first, &live.edits());
  } catch (...) {
    next_servo_ns_ = 2 * monotonicNow_ns() - from_ns;
    throw;
  }
  TouchRig& rig = *made;
  rig.drawFor(pictures_.view());
  rig.keepTicks(kOnlookRoom.ticks);
  std::atomic<bool> ticks{false};
  const auto work = [&](std::int64_t now_ns) {
    lookForOnlookers(rig);
    static_cast<void>(lookAround(now_ns));
    noteMemory(now_ns);
    if (engine.broken()) is_broken.store(true, std::memory_order_relaxed);
  };
  const auto follow = [&, first_version = servo_->firstVersion()](const ToolPose& pose, std::int64_t now_ns) {
    ticks.store(true, std::memory_order_relaxed);
    faults_.look(pose.faults, now_ns, tell_);
    {
      const std::lock_guard lock(mutex_);
      notePose(status_, pose, first_version, now_ns);
      status_.force_off = servo_->device().forceOff();
    }
    work(now_ns);
  };
  rig.start(follow, work);
  const std::int64_t started_ns = monotonicNow_ns();
  struct Lent {
    ServedVolume& served;
    ~Lent() { served.lendRig(nullptr); }
  } const lent{*this};
  lendRig(&rig);
  door_->noTrouble();
  tell_(fmt::format("a servo with the device '{}' touches {}", servo_->device().name(), live.name()));
  for (const std::string& warning : rig.warnings(rig.settings())) tell_(warning);
  const auto goes_on = [&] {
    if (stop_ || is_broken.load(std::memory_order_relaxed)) return false;
    if (!rig.running() || !live.edits().counts().editing) return false;
    const std::lock_guard lock(mutex_);
    return !wanted_filter_;
  };
  while (goes_on()) {
    if (!ticks && monotonicNow_ns() - started_ns > kFirstTick_ns) {
      tell_("the servo does not begin: it is let go");
      break;
    }
    heedRig(rig);
    std::this_thread::sleep_for(kRigLook);
  }
  lendRig(nullptr);
  rig.requestStop();
  static_cast<void>(rig.wait());
}

void ServedVolume::lookAlone() {
  LiveVolume& live = engine_->live();
  const std::int64_t now_ns = monotonicNow_ns();
  takeIsovalueAlone();
  live.edits().look(ToolPose{}, now_ns);
  const bool draws = pictures_.view().look(live.engine(), now_ns);
  noteMemory(now_ns);
  if (!lookAround(now_ns) && !draws) std::this_thread::sleep_for(kIdle);
}

// What is to be done at every look beside edits and windows. Whether more is to be drawn.
bool ServedVolume::lookAround(std::int64_t now_ns) {
  looked_at_ns_.store(monotonicNow_ns(), std::memory_order_relaxed);
  settle();
  engine_->lookAfterJournal(now_ns);
  const Engine& engine = engine_->live().engine();
  if (engine.broken()) return false;  // drawn by the next one
  const std::uint64_t version = engine.editVersion();
  if (!pictures_.drawOn(version, onlookers_.mayBeInterrupted(version)))
    return onlookers_.drawOn(pictures_.view(), version, now_ns);
  onlookers_.interrupt();
  return true;
}

// Their pointers lead the tool, unless a person holds the device.
void ServedVolume::lookForOnlookers(TouchRig& rig) {
  told_.clear();
  rig.ticks().take(told_);
  if (!told_.empty()) {
    const std::lock_guard lock(mutex_);
    status_.window_age_ns = told_.back().window_age_ns;
  }
  onlookers_.pass(told_);
  const std::optional<PointerTarget> target = onlookers_.takeAim();
  if (target && !isHeld(first_scene_)) servo_->aim(*target);
}

void ServedVolume::noteMemory(std::int64_t now_ns) {
  if (memory_at_ns_ != 0 && now_ns - memory_at_ns_ < kMemoryLook_ns) return;
  memory_at_ns_ = now_ns;
  std::uint64_t bytes = 0;
  for (const MemoryFigure& one : engine_->live().engine().memory()) bytes += one.bytes;
  const std::lock_guard lock(mutex_);
  status_.gpu_bytes = bytes;
}

ServedStatus ServedVolume::status() const {
  std::unique_lock lock(mutex_);
  ServedStatus status = status_;
  lock.unlock();
  const LiveVolume& live = engine_->live();
  const RigEdits::Counts counts = live.edits().counts();
  status.edits += counts.edits;
  status.refused += counts.refused;
  status.undoable = counts.done;
  status.waiting = counts.waiting;
  status.redoable = counts.undone;
  status.unsaved = live.isUnsaved();
  status.lost_records = live.lostRecords();
  if (const JournalWriter* const journal = live.session().journal()) {
    status.waiting_for_disk = answers_.waiting();
    status.journal_bytes = journal->bytes();
    if (journal->failed()) status.journal_failure = journal->failure();
  }
  return status;
}

// By the engine's thread, once the edit is made or refused.
ServedVolume::Done ServedVolume::onDisk(Done done) {
  return [this, done = std::move(done)](const std::optional<Error>& refusal) {
    const JournalWriter* const journal = engine_->live().session().journal();
    if (refusal || journal == nullptr) return done(refusal);
    answers_.add(*journal, done);
  };
}

void ServedVolume::settle() {
  if (const JournalWriter* const journal = engine_->live().session().journal()) answers_.settle(*journal);
}

std::shared_ptr<Onlooker> ServedVolume::lookOn() {
  return onlookers_.add(kOnlookRoom);
}

void ServedVolume::leave(const std::shared_ptr<Onlooker>& one) {
  onlookers_.remove(one);
  release(one);
}

void ServedVolume::hold(const std::shared_ptr<Onlooker>& one, BrushHolders::Turn turn, const ToolBrushSpec& brush) {
  holders_.hold(one, turn, [&] {
    if (!edits().setBrush(brush)) throw tooManyWait("the brush");
  });
}

void ServedVolume::release(const std::shared_ptr<Onlooker>& one) {
  holders_.release(one, [&] { static_cast<void>(edits().dropBrush()); });  // not taken: editing has ended
}

void ServedVolume::goTo(std::size_t done) {
  if (!edits().goTo(done)) throw tooManyWait("a place in the list of edits");
}

ServedFacts ServedVolume::facts() const {
  ServedFacts facts{.volume = seen_volume_,
                    .device = first_scene_.device,
                    .device_is_held = isHeld(first_scene_),
                    .keeps_journal = keepsJournal(),
                    .plan = {},
                    .settings = settingsOf(scene())};
  const std::lock_guard lock(engines_);
  facts.plan = engine_->plan();
  return facts;
}

Looked ServedVolume::looked(const Onlooker& one, const std::optional<std::uint64_t>& known) const {
  Looked looked;
  {
    const std::lock_guard lock(mutex_);
    looked.has_servo = status_.servo;
    looked.force_off = status_.force_off;
  }
  const LiveVolume& live = engine_->live();
  const RigEdits::Counts counts = live.edits().counts();
  looked.has_steps = known != counts.edits;
  if (looked.has_steps) {
    looked.edits = live.edits().state();
  } else {
    static_cast<RigEdits::Counts&>(looked.edits) = counts;
  }
  looked.can_edit = counts.editing;
  looked.settings = settingsOf(scene());
  looked.drawing_failure = onlookers_.failure(one);
  looked.journal_failure = live.journalFailure();
  return looked;
}

// While the engine is being made anew all of these wait for the next one.
void ServedVolume::edit(std::vector<EditCommand> commands, Done done) {
  edits().edit(std::move(commands), onDisk(std::move(done)));
}
void ServedVolume::undo(Done done) {
  edits().undo(onDisk(std::move(done)));
}
void ServedVolume::redo(Done done) {
  edits().redo(onDisk(std::move(done)));
}
void ServedVolume::save(const std::string& file, std::function<void(const LiveVolume::Saved&)> done) {
  engine_->live().save(file, scene().isovalue.value_or(first_isovalue_), std::move(done));
}

void ServedVolume::render(int width, int height, PictureQueue::Done done) {
  RenderRequest request;
  request.width = width;
  request.height = height;
  const double distance_m = fittingDistance(request, seen_volume_.object);
  pictures_.ask({.camera = frameCamera(request, seen_volume_.object.middle_W, distance_m, 0), .style = {}},
                std::move(done));
}

Scene ServedVolume::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
}

}  // namespace palpate
