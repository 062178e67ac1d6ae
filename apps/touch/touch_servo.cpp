// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/touch_servo.hpp"

#include <cmath>
#include <utility>

#include "apps/held/held_device.hpp"
#include "apps/held/held_words.hpp"
#include "apps/rig/remote_windows.hpp"
#include "apps/servo_setup/contact_bounds.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "servo/devices/force_off.hpp"

namespace palpate {
namespace {

// So many reads of the device a run has at most: one before the first tick.
std::size_t mostReads(const Scene& scene) {
  return static_cast<std::size_t>(std::round(scene.duration_s * scene.rate_hz) + 2);
}

}  // namespace

void TouchServo::make(const Scene& scene, const TouchPlace& place, Engine& engine) {
  if (isHeld(scene)) held_ = scene.device;
  contact_ = {stiffnessOf(scene), dampingOf(scene)};
  scene.service ? makeThere(scene, place, engine) : makeHere(scene, place);
}

void TouchServo::makeHere(const Scene& scene, const TouchPlace& place) {
  SceneDevice made = makeSceneDevice(scene, place.path, place.box);
  device_ = std::move(made.device);
  if (!scene.record.empty()) {
    auto recorder = std::make_unique<RecordingDevice>(std::move(device_), scene.rate_hz, mostReads(scene));
    recorder_ = recorder.get();
    device_ = std::move(recorder);
  }
  chooseContact(scene, place, made.placement, made.session);
}

// The servo's process makes the device, and reads the windows that this one publishes.
void TouchServo::makeThere(const Scene& scene, const TouchPlace& place, Engine& engine) {
  process_.emplace();
  remote_ = std::make_unique<RemoteServo>(
      process_->takeChannel(), RemoteServo::Request{.scene = scene,
                                                    .box = place.box,
                                                    .way = hasPath(scene) ? &place.path : nullptr,
                                                    .window_samples = engine.windowCapacity(),
                                                    .recorded_reads = scene.record.empty() ? 0 : mostReads(scene),
                                                    .commit = place.commit});
  publishTo(*remote_, engine);
  std::optional<Placement> placed;
  if (remote_->placed()) placed = {.scale = remote_->placed()->scale, .force_scale = remote_->placed()->force_scale};
  chooseContact(scene, place, placed, remote_->session());
}

void TouchServo::chooseContact(const Scene& scene, const TouchPlace& place, const std::optional<Placement>& placement,
                               const std::optional<RecordedContact>& session) {
  const Scene& asked = place.asked;
  if (session) {
    if (!asked.stiffness_N_per_m) contact_.stiffness_N_per_m = session->stiffness_N_per_m;
    if (!asked.damping_Ns_per_m) contact_.damping_Ns_per_m = session->damping_Ns_per_m;
  }
  if (!placement) return;
  if (!asked.damping_Ns_per_m)
    contact_.damping_Ns_per_m = usualDamping(rigSettings(asked, place.isovalue), loopParameters(asked), device());
  Scene damped = scene;
  damped.damping_Ns_per_m = contact_.damping_Ns_per_m;
  if (!asked.stiffness_N_per_m)
    contact_.stiffness_N_per_m = usualStiffness(rigSettings(damped, place.isovalue), loopParameters(asked), device());
  warnings_ = heldDeviceWords(scene.device, device(), *placement, contact_.stiffness_N_per_m);
}

ServoRun TouchServo::run(const Scene& scene, RigVolume volume, Engine& engine, RigEdits* edits, Progress& progress,
                         const BeforeFirstTick& before_first_tick) {
  if (remote_) return runServo(scene, std::move(volume), *remote_, engine, edits, progress, before_first_tick);
  return runServo(scene, std::move(volume), *device_, engine, edits, progress, before_first_tick);
}

std::optional<RunDevice> TouchServo::letGo() {
  std::optional<RunDevice> run;
  if (!held_.empty()) {
    run = RunDevice{.kind = held_, .force_off = std::string(wordsOf(device().forceOff()).name)};
    if (remote_) run->figures = remote_->deviceFigures();
    if (!remote_)
      for (const DeviceFigure& figure : device_->figures()) run->figures.emplace_back(figure.key, figure.value);
  }
  if (remote_) recording_ = remote_->recording();
  if (recorder_ != nullptr) recording_ = recorder_->recording();
  process_.reset();
  recorder_ = nullptr;
  device_.reset();
  if (recording_) recording_->contact = contact_;
  return run;
}

}  // namespace palpate
