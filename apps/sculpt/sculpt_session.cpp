// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/sculpt_session.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "apps/held/held_device.hpp"
#include "apps/held/held_words.hpp"
#include "apps/rig/remote_windows.hpp"
#include "apps/servo_setup/contact_bounds.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/servo_process.hpp"
#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/service/engine.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {
namespace {

constexpr std::size_t kKeptTicks = 8192;  // between two frames of the window

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

}  // namespace

Scene withMouse() {
  Scene scene;
  scene.device = "mouse";
  return scene;
}

SculptSession::SculptSession(const SculptRequest& request, Progress& progress)
    : scene_(request.device),
      held_device_(request.held),
      loop_(request.loop),
      first_settings_(request.servo),
      commit_(request.commit),
      is_held_(isHeld(request.device)) {
  checkDevice(scene_);  // before the work
  const Plan plan = makePlan({.edits = true, .other_isovalues = true, .draws = true});
  live_.emplace(LiveVolumeRequest{.volume = request.volume,
                                  .isovalue = request.isovalue,
                                  .gpu = request.gpu,
                                  .gpu_memory_bytes = request.gpu_memory_bytes,
                                  .plan = plan,
                                  .journal = request.journal,
                                  .recovers = request.recovers,
                                  .undo_bytes = request.undo_bytes,
                                  .work = "palpate sculpt",
                                  .takes_filters = false},
                progress, [this](const std::string& text) { tell(text); });
  const Volume& volume = live_->volume();
  Engine& engine = live_->engine();
  const double isovalue = live_->firstIsovalue();
  plan_ = planLines(plan, engine.planFacts());
  facts_ = {request.volume, volume.size(), volume.lattice(), statisticsOf(volume), {}};
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  facts_.object = objectExtent(engine.bounds(), grid, volume.lattice(), static_cast<float>(isovalue), {}, &volume);
  scale_ = densityScaleOf(volume, isovalue);
  loop_.ticks = 0;
  loop_.record_ticks = 1;
  scene_.rate_hz = loop_.rate_hz;
  first_settings_.parameters.isovalue = isovalue;
  first_settings_.parameters.rate_hz = loop_.rate_hz;
  if (is_held_) return;  // start() takes it over from the volume before
  if (scene_.service) {
    makeRemote();
    makeRig();
  } else {
    path_.emplace(restingPlace(facts_.object));
    path_->follow(aims_);
    aim_.emplace(aims_);
    device_ = makeDevice(scene_.device, {.path = &*path_, .rate_hz = loop_.rate_hz});
    makeRig();
  }
}

// The servo's process makes the device, and reads the windows that this one publishes.
void SculptSession::makeRemote() {
  Engine& engine = live_->engine();
  const Vec3 rests_W = restingPlace(facts_.object);
  if (remote_) {  // a start that failed; its device is let go first
    remote_->leave();
    last_ = std::move(remote_);
  }
  process_.reset();
  process_ = std::make_unique<ServoProcess>();
  remote_ = std::make_unique<RemoteServo>(process_->takeChannel(),
                                          RemoteServo::Request{.scene = scene_,
                                                               .box = boxOf(facts_.lattice, facts_.size),
                                                               .pointer = is_held_ ? nullptr : &rests_W,
                                                               .told_ticks = kKeptTicks,
                                                               .window_samples = engine.windowCapacity(),
                                                               .commit = commit_});
  publishTo(*remote_, engine);
  last_.reset();
}

const Device& SculptSession::theDevice() const {
  return remote_ ? remote_->device() : *device_;
}

ForceOff SculptSession::forceOff() const noexcept {
  if (remote_ && remote_->isGone()) return ForceOff::kNone;
  return remote_ || device_ ? theDevice().forceOff() : ForceOff::kNone;
}

void SculptSession::aim(const PointerTarget& target) noexcept {
  if (aim_) aim_->aim(target);
  if (remote_ && !is_held_) remote_->aim(target);
}

void SculptSession::makeRig() {
  for (const std::string& warning : boundWarnings(first_settings_, loop_, theDevice())) tell(warning);
  const RigVolume volume{.scale = scale_};
  Engine& engine = live_->engine();
  rig_ = remote_ ? std::make_unique<TouchRig>(engine, *remote_, loop_, volume, first_settings_, &live_->edits())
                 : std::make_unique<TouchRig>(engine, *device_, loop_, volume, first_settings_, &live_->edits());
  rig_->drawFor(view_);
  rig_->keepTicks(kKeptTicks);
}

SculptSession::~SculptSession() {
  try {
    close();
  } catch (const std::exception&) {  // nobody is left who could be told
  }
}

const gpu::GpuInfo& SculptSession::gpu() const noexcept {
  return live_->engine().gpu();
}

void SculptSession::start() {
  if (!rig_) {
    Placement placement;
    if (scene_.service) {
      makeRemote();
      if (remote_->placed())
        placement = {.scale = remote_->placed()->scale, .force_scale = remote_->placed()->force_scale};
    } else {
      HeldDevice held = placeHeldDevice(held_device_, scene_, boxOf(facts_.lattice, facts_.size));
      device_ = std::move(held.device);
      placement = held.placement;
    }
    first_settings_.parameters.damping_Ns_per_m = usualDamping(first_settings_, loop_, theDevice());
    first_settings_.parameters.stiffness_N_per_m = usualStiffness(first_settings_, loop_, theDevice());
    for (const std::string& words :
         heldDeviceWords(scene_.device, theDevice(), placement, first_settings_.parameters.stiffness_N_per_m))
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

void SculptSession::save(const std::string& file) {
  live_->save(file, settings().parameters.isovalue, [this](const LiveVolume::Saved& saved) { tell(saved.words); });
}

SculptState SculptSession::look() {
  SculptState state;
  state.edits = live_->edits().state();
  state.running = rig_->running();
  state.missing_servo = "the servo has ended: open the volume again";
  state.force_off = theDevice().forceOff();
  state.can_edit = rig_->engineWorks() && state.edits.editing;
  if (remote_ && remote_->isGone() && !closed_ && !std::exchange(told_its_end_, true))
    tell(
        "the servo's process has ended; nothing is lost, and the volume can be edited and saved: open it anew for "
        "another servo");
  state.errands = live_->errands();  // before what they have saved
  state.unsaved = live_->isUnsaved();
  state.drawing_failure = view_.failure();
  state.journal_failure = live_->journalFailure();
  if (const auto refusal = rig_->takeRefusal()) tell(refusal->what());
  const std::lock_guard lock(mutex_);
  state.messages = std::exchange(messages_, {});
  return state;
}

void SculptSession::press(const ToolBrushSpec& brush) {
  if (live_->edits().setBrush(brush)) held_ = toolBrushText(brush);
}

void SculptSession::release() {
  static_cast<void>(live_->edits().dropBrush());
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
    const bool is_told = remote_ && remote_->isGone() && !rig_->engineFailed();  // the servo's end, which loses nothing
    if (!is_told) failure = std::current_exception();
  }
  try {
    if (live_) live_->close();
  } catch (...) {
    if (!failure) failure = std::current_exception();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
