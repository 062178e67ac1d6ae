// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/sculpt_session.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/held/held_device.hpp"
#include "apps/held/held_words.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "apps/servo_setup/contact_bounds.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/acknowledged_file.hpp"
#include "engine/journal/replay.hpp"
#include "engine/journal/volume_identity.hpp"
#include "engine/service/engine.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {
namespace {

constexpr std::size_t kKeptTicks = 8192;  // between two frames of the window

void stopIfInterrupted() {
  throwIfInterrupted("palpate sculpt");
}

// In front of the object, away from it by a quarter of its size.
Vec3 restingPlace(const SeenExtent& object) {
  double front_m = 0;
  for (const Vec3& point_W : object.points_W) front_m = std::max(front_m, object.middle_W.y() - point_W.y());
  return object.middle_W - Vec3(0, 1.5 * front_m, 0);
}

void checkDevice(const Scene& scene) {
  if (isHeld(scene) || deviceEntry(scene.device).needs_path) return;
  refuse("--device " + scene.device, "a window plays no recording back", "take 'palpate touch' for that");
}

// The file, and the folder if nothing else is in it.
void removeJournal(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(journalFile(folder), ignored);
  std::filesystem::remove(folder, ignored);
}

}  // namespace

Scene withMouse() {
  Scene scene;
  scene.device = "mouse";
  return scene;
}

SculptSession::SculptSession(const SculptRequest& request, Progress& progress)
    : journal_(request.journal),
      scene_(request.device),
      held_device_(request.held),
      loop_(request.loop),
      first_settings_(request.servo) {
  checkDevice(scene_);  // before the work
  progress.stage("loading " + request.volume);
  volume_ = loadAndTell(request.volume, progress);
  if (const std::string& remark = volume_->facts().remark; !remark.empty()) tell(remark);
  checkTouchable(*volume_);
  std::optional<Journal> journal;
  if (!request.recovers.empty()) {
    journal = readJournal(request.recovers);
    checkStart(*journal, *volume_, request.volume);
    first_isovalue_ = journal->header.profile.isovalue;
  } else {
    first_isovalue_ = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(*volume_));
  }
  checkIsovalue(*volume_, first_isovalue_);
  stopIfInterrupted();
  const Plan plan = makePlan({.edits = true, .other_isovalues = true, .draws = true});
  progress.stage("computing on Vulkan");
  engine_ = std::make_unique<Engine>(*volume_, plan, first_isovalue_, request.gpu, request.gpu_memory_bytes,
                                     passProgress(progress, stopIfInterrupted));
  plan_ = planLines(plan, engine_->planFacts());
  facts_ = {request.volume, volume_->size(), volume_->lattice(), statisticsOf(*volume_), {}};
  const BrickGrid grid{volume_->size(), volume_->lattice().spacing_m};
  facts_.object =
      objectExtent(engine_->bounds(), grid, volume_->lattice(), static_cast<float>(first_isovalue_), {}, &*volume_);

  const BrushProfile profile = journal ? journal->header.profile : brushProfile(*volume_, first_isovalue_);
  session_ = std::make_unique<EditSession>(*engine_, profile, std::span<const EditKind>{}, request.undo_bytes);
  edits_ = std::make_unique<RigEdits>(*session_, volume_->size(), volume_->lattice(),
                                      [this](const std::string& text) { tell(text); });
  if (!journal_.empty()) session_->keepJournal(journal_, identityOf(*volume_), watchedJournal());
  volume_->keepIsovalue(first_isovalue_);
  scale_ = densityScaleOf(*volume_, first_isovalue_);
  session_->keepSaved(*volume_, {}, 0);
  if (journal) makeAgain(*journal, progress);
  if (journal && !journalHolds())
    tell(fmt::format("the edits stay in {}, since the new journal cannot be written", request.recovers.string()));

  loop_.ticks = 0;
  loop_.record_ticks = 1;
  scene_.rate_hz = loop_.rate_hz;
  first_settings_.parameters.isovalue = first_isovalue_;
  first_settings_.parameters.rate_hz = loop_.rate_hz;
  if (!held_device_) {
    path_.emplace(restingPlace(facts_.object));
    device_ = makeDevice(scene_.device, {.path = &*path_, .rate_hz = loop_.rate_hz});
    makeRig();
  }
}

void SculptSession::makeRig() {
  for (const std::string& warning : boundWarnings(first_settings_, loop_, *device_)) tell(warning);
  rig_ =
      std::make_unique<TouchRig>(*engine_, *device_, loop_, RigVolume{.scale = scale_}, first_settings_, edits_.get());
  rig_->drawFor(view_);
  rig_->keepTicks(kKeptTicks);
}

bool SculptSession::journalHolds() {
  return session_->flushJournal();
}

// As edits of this session, so that its journal holds them too.
void SculptSession::makeAgain(const Journal& journal, Progress& progress) {
  progress.stage("making the edits again");
  const std::vector<std::vector<EditCommand>> edits = lastingEdits(journal);
  for (std::size_t i = 0; i < edits.size(); ++i) {
    stopIfInterrupted();
    progress.fraction(static_cast<double>(i) / static_cast<double>(edits.size()));
    static_cast<void>(session_->edit(edits[i], 0));
  }
}

SculptSession::~SculptSession() {
  try {
    close();
  } catch (const std::exception&) {  // nobody is left who could be told
  }
}

const gpu::GpuInfo& SculptSession::gpu() const noexcept {
  return engine_->gpu();
}

void SculptSession::start() {
  if (!rig_) {
    HeldDevice held = placeHeldDevice(held_device_, scene_, boxOf(facts_.lattice, facts_.size));
    device_ = std::move(held.device);
    first_settings_.parameters.damping_Ns_per_m = usualDamping(first_settings_, loop_, *device_);
    first_settings_.parameters.stiffness_N_per_m = usualStiffness(first_settings_, loop_, *device_);
    for (const std::string& words :
         heldDeviceWords(scene_.device, *device_, held.placement, first_settings_.parameters.stiffness_N_per_m))
      tell(words);
    makeRig();
  }
  rig_->start();
  started_ = true;
}

void SculptSession::tell(const std::string& text) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(text);
}

// Of a file that was asked for: it is told what became of it, also where nobody gets to it any more.
class SculptSession::SavePromise {
 public:
  SavePromise(SculptSession& session, std::string file) : session_(session), file_(std::move(file)) {
    ++session_.errands_;
  }
  ~SavePromise() {
    if (!kept_) session_.tell(file_ + " was not written: editing has ended");
    --session_.errands_;
  }
  SavePromise(const SavePromise&) = delete;
  SavePromise& operator=(const SavePromise&) = delete;
  void keep(const std::string& outcome) {
    session_.tell(outcome);
    kept_ = true;
  }

 private:
  SculptSession& session_;
  const std::string file_;
  bool kept_ = false;
};

void SculptSession::save(const std::string& file) {
  ConvertRequest request{.in = facts_.name, .out = file};
  if (isMeshFileName(file)) request.isovalue = settings().parameters.isovalue;
  checkOutput(request);
  const std::uint64_t content = edits_->state().content_version;
  const bool is_volume = isVolumeFileName(file);
  const auto promise = std::make_shared<SavePromise>(*this, request.out);
  static_cast<void>(edits_->errand([this, promise, request, content, is_volume](const Volume& volume, std::uint64_t) {
    try {
      Progress silent(nullptr);
      AtomicFile target(request.out);
      const ConvertResult result = writeOutput(volume, request, "palpate sculpt", target, silent);
      target.commit();
      if (is_volume) saved_version_ = std::max(saved_version_.load(), content);
      promise->keep(convertWords(request, result));
    } catch (const std::exception& error) {
      promise->keep(fmt::format("{} was not written: {}", request.out, error.what()));
    }
  }));
}

bool SculptSession::isUnsaved(const RigEdits::State& state) const {
  return state.content_version > saved_version_.load();
}

SculptState SculptSession::look() {
  SculptState state;
  state.edits = edits_->state();
  state.running = rig_->running();
  state.force_off = device_->forceOff();
  state.errands = errands_.load();  // before what they have saved
  state.unsaved = isUnsaved(state.edits);
  state.drawing_failure = view_.failure();
  if (const JournalWriter* journal = session_->journal(); journal != nullptr && journal->failed())
    state.journal_failure = journal->failure();
  if (const auto refusal = rig_->takeRefusal()) tell(refusal->what());
  const std::lock_guard lock(mutex_);
  state.messages = std::exchange(messages_, {});
  return state;
}

void SculptSession::press(const ToolBrushSpec& brush) {
  if (edits_->setBrush(brush)) held_ = toolBrushText(brush);
}

void SculptSession::release() {
  static_cast<void>(edits_->dropBrush());
  held_.clear();
}

void SculptSession::close() {
  if (std::exchange(closed_, true)) return;
  std::exception_ptr failure;
  try {
    if (started_) {
      rig_->requestStop();
      static_cast<void>(rig_->wait());
    }
  } catch (...) {
    failure = std::current_exception();
  }
  if (session_) {
    edits_->doWaiting(0);  // a file that was asked for last
    session_->close();
    const bool unsaved = isUnsaved(edits_->state());
    if (!journal_.empty() && !unsaved) removeJournal(journal_);
    const JournalWriter* journal = session_->journal();
    if (!failure && unsaved && journal != nullptr && !journal->failure().empty()) {
      failure = std::make_exception_ptr(Error(Error::Code::kIo, journal_.string(),
                                              "edits are lost that no file holds: " + journal->failure(),
                                              "'palpate recover' brings back those before"));
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
