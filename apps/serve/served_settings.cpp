// SPDX-License-Identifier: Apache-2.0
// The settings of a served volume, and their way to the servo: at once, or with the gradients of another isovalue.
#include <utility>

#include <fmt/format.h>

#include "apps/rig/touch_rig.hpp"
#include "apps/serve/live_setting.hpp"
#include "apps/serve/served_engine.hpp"
#include "apps/serve/served_volume.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostBricks = 65536;  // of a portion of another isovalue's gradients

// So that what is not set cannot be told from what is usual.
Scene withUsual(Scene scene) {
  scene.stiffness_N_per_m = stiffnessOf(scene);
  scene.damping_Ns_per_m = dampingOf(scene);
  return scene;
}

}  // namespace

// From before a crash, one by one of the right kind: whether they fit each other and this engine shows here.
void ServedVolume::takeSettings(const Scene& settings) {
  scene_ = withUsual(first_scene_);
  scene_.filter = settings.filter;
  scene_.isovalue = first_isovalue_;
  if (first_scene_.isovalue && engine_->canChangeIsovalue()) scene_.isovalue = first_scene_.isovalue;
  Scene next = withUsual(settings);
  // The engine begins with the journal's, if there are edits from before, whatever the scene says.
  const bool goes_elsewhere = settings.isovalue && static_cast<float>(*settings.isovalue) != first_isovalue_;
  const bool is_the_scenes = settings.isovalue == first_scene_.isovalue;  // what is kept is told by KeptSettings
  if (goes_elsewhere && is_the_scenes && !engine_->canChangeIsovalue())
    tell_(fmt::format(
        "isovalue {}: the edits from before were made with {}, and this scene's samples serve that one alone; undo the "
        "edits, or name another --journal",
        *settings.isovalue, first_isovalue_));
  if (!goes_elsewhere || !engine_->canChangeIsovalue()) next.isovalue = first_isovalue_;
  try {
    checkFollowsEdits(next.algorithm, "servo.algorithm = " + next.algorithm);
    checkHasGradients(next.algorithm, engine_->gradientEverywhere());
    static_cast<void>(makeAlgorithm(settingsOf(next), RigVolume{.scale = engine_->scale()}));
    scene_ = next;
  } catch (const Error& error) {
    tell_(fmt::format("settings from before do not fit: {}", error.what()));
  }
}

RigSettings ServedVolume::settingsOf(const Scene& scene) const {
  return rigSettings(scene, wantedIsovalue(scene));
}

// Settings that changed since the rig was made are the servo's from now on.
void ServedVolume::lendRig(TouchRig* rig) {
  const std::lock_guard order(changers_);
  if (rig != nullptr) rig->change(settingsOf(scene()));
  rig_ = rig;
}

std::vector<std::string> ServedVolume::warnings() const {
  const std::lock_guard order(changers_);
  return rig_ != nullptr ? rig_->warnings(settingsOf(scene())) : std::vector<std::string>{};
}

std::string ServedVolume::stairs() const {
  const Scene now = scene();
  return engine_->live().stairsAt(now.isovalue.value_or(first_isovalue_), servedPlan(now));
}

void ServedVolume::heedRig(TouchRig& rig) {
  const double isovalue = rig.settings().parameters.isovalue;  // first: it is this one that has settled
  if (const std::optional<Error> refusal = rig.takeRefusal()) {
    const std::lock_guard order(changers_);
    endIsovalue(*refusal, rig.settings().parameters.isovalue);
    rig.change(settingsOf(scene()));  // what else was set meanwhile waited for the isovalue
  } else if (rig.isSettled()) {
    noteReached(isovalue);
  }
}

void ServedVolume::noteReached(double isovalue) {
  {
    const std::lock_guard lock(mutex_);
    felt_isovalue_ = isovalue;
  }
  asked_isovalues_.reached(isovalue);
}

bool ServedVolume::isIsovalueFelt() const {
  const std::lock_guard lock(mutex_);
  return wantedIsovalue(scene_) == felt_isovalue_;
}

// One that the engine refused is not asked for again. `in_use`: what the contact is of, or will be. No change comes in
// between.
void ServedVolume::endIsovalue(const Error& refusal, double in_use) {
  {
    const std::lock_guard lock(mutex_);
    scene_.isovalue = in_use;
  }
  if (!asked_isovalues_.refuse(refusal, in_use)) tell_(refusal.what());
}

double ServedVolume::wantedIsovalue(const Scene& scene) const {
  return scene.field == "distance" ? 0 : static_cast<float>(scene.isovalue.value_or(first_isovalue_));
}

// Nobody waits for windows meanwhile.
void ServedVolume::takeIsovalueAlone() {
  Engine& engine = engine_->live().engine();
  const double wanted = wantedIsovalue(scene());
  if (wanted == engine.isovalue()) return noteReached(wanted);
  const double before = engine.isovalue();
  try {
    engine.beginIsovalue(wanted);
    while (!engine.gatherIsovalue(kMostBricks, monotonicNow_ns()))
      looked_at_ns_.store(monotonicNow_ns(), std::memory_order_relaxed);  // it lives
    engine.endIsovalue(wanted);
    noteReached(wanted);
  } catch (const Error& error) {
    if (error.code() != Error::Code::kBadInput && error.code() != Error::Code::kOutOfMemory) throw;
    const std::lock_guard order(changers_);
    const double newest = wantedIsovalue(scene());
    endIsovalue(error, newest == wanted ? before : newest);
  }
}

void ServedVolume::change(const RigSettings& before, const RigSettings& wanted, Done done) {
  const Scene present = scene();
  const RigSettings settings = withChanges(settingsOf(present), before, wanted);
  Scene next = withRigSettings(present, settings);
  if (settings.parameters.isovalue == wantedIsovalue(present)) next.isovalue = present.isovalue;
  checkLiveSettings(present, next);
  constexpr std::size_t kMostRows = 256;  // whoever looks on is told them in one message
  if (settings.haptization.density.size() > kMostRows || settings.haptization.gradient.size() > kMostRows)
    refuse("haptization", fmt::format("a table has more than {} rows", kMostRows), "give fewer");
  change(next, std::move(done));
}

void ServedVolume::change(const Scene& wanted, Done done, Awaits awaits) {
  checkFollowsEdits(wanted.algorithm, "servo.algorithm = " + wanted.algorithm);
  {
    const std::lock_guard order(changers_);
    const bool goes_elsewhere = wanted.isovalue != scene().isovalue;
    checkPossible(wanted, goes_elsewhere);
    if (rig_ != nullptr) rig_->change(settingsOf(wanted));
    {
      const std::lock_guard lock(mutex_);
      const std::string filter = scene_.filter;
      scene_ = wanted;
      scene_.filter = filter;
    }
    // Before anybody can refuse it.
    if (goes_elsewhere || awaits == Awaits::kTheIsovalue)
      return asked_isovalues_.add(wantedIsovalue(wanted), std::move(done));
  }
  done({});  // without the lock, as it may ask for warnings()
}

void ServedVolume::checkPossible(const Scene& wanted, bool goes_elsewhere) const {
  const std::lock_guard lock(engines_);
  if (!is_ready_) throw Error(Error::Code::kDevice, "the engine", "it is being made anew", "ask again in a moment");
  if (goes_elsewhere && !engine_->canChangeIsovalue())
    refuse("isovalue", "what is on the device serves the first one alone", "change it in the scene and start again");
  if (rig_ == nullptr) {
    checkHasGradients(wanted.algorithm, engine_->gradientEverywhere());
    static_cast<void>(makeAlgorithm(settingsOf(wanted), RigVolume{.scale = engine_->scale()}));  // or says why not
  }
}

}  // namespace palpate
