// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/scene_device.hpp: the haptic device of a run along a path, of a recorded session, or in a person's
// hand.
//
// Set-up code. Throws Error: as makeDevice(), openHeldDevice(), placeHeldDevice() and loadRecording() do.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/held/placement_choice.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/recording.hpp"

namespace palpate {

// Whether a path leads it: nobody holds it, and no recording is played back.
[[nodiscard]] bool hasPath(const Scene& scene);

// Before the volume is loaded: the scene's device is there and may be used, and so are its files.
void checkDevice(const Scene& scene);

struct SceneDevice {
  std::unique_ptr<Device> device;
  std::optional<Placement> placement;           // of a device that is held
  std::optional<RecordedContact> session = {};  // with which a recorded session was felt
};
// `path` leads a simulated device.
[[nodiscard]] SceneDevice makeSceneDevice(const Scene& scene, const Path& path, const VolumeBox& box);

}  // namespace palpate
