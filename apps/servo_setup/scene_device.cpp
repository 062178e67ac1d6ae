// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/scene_device.hpp"

#include "apps/held/held_device.hpp"
#include "apps/servo_setup/recording_file.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {
bool hasPath(const Scene& scene) {
  return !isHeld(scene) && scene.device != kRecorded;
}

void checkDevice(const Scene& scene) {
  if (!scene.record.empty()) checkRecordable(scene.record);
  checkHeldDevice(scene);
  if (isHeld(scene)) return;
  if (scene.device == kRecorded) static_cast<void>(loadRecording(scene.recording));
  if (deviceEntry(scene.device).needs_pointer) {
    refuse("--device " + scene.device, "a run along a path has no window, and so no pointer",
           "give --device simulated, or take 'palpate sculpt'");
  }
}

SceneDevice makeSceneDevice(const Scene& scene, const Path& path, const VolumeBox& box) {
  if (isHeld(scene)) {
    HeldDevice held = placeHeldDevice(openHeldDevice(scene), scene, box);
    return {.device = std::move(held.device), .placement = held.placement};
  }
  if (scene.device != kRecorded)
    return {.device = makeDevice(scene.device, deviceSetup(scene, path)), .placement = std::nullopt};
  DeviceSetup setup{.rate_hz = scene.rate_hz};
  setup.recording = loadRecording(scene.recording);
  return {.device = makeDevice(scene.device, setup), .placement = std::nullopt, .session = setup.recording->contact};
}

}  // namespace palpate
