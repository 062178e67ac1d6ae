// SPDX-License-Identifier: Apache-2.0
// apps/touch/touch_servo.hpp: the device and the servo of a run, in this process or, with --service, in one of their
// own. Set-up code, one thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/touch_run.hpp"
#include "apps/scene/scene.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/servo_process.hpp"
#include "apps/touch/servo_run.hpp"
#include "engine/service/engine.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/recording.hpp"
#include "servo/devices/recording_device.hpp"

namespace palpate {

// Where the device is, and what the user asked for: a setting that is not there is chosen by the device. The path is
// used until letGo(), unless the scene has none.
struct TouchPlace {
  const SampledPath& path;
  VolumeBox box;
  double isovalue = 0;
  const Scene& asked;
  const std::string& commit;  // of this program
};

class TouchServo {
 public:
  // Makes the device of `scene`, in which what is not asked for has its usual value. With --service starts the process,
  // and lets the engine publish into its memory. Throws Error as makeSceneDevice() and RemoteServo do.
  void make(const Scene& scene, const TouchPlace& place, Engine& engine);
  // The surface's stiffness and damping: as asked for, or the recorded session's, or what a device that is held bears.
  [[nodiscard]] const RecordedContact& contact() const noexcept { return contact_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }

  // As runServo() does; with the scene's contact.
  [[nodiscard]] ServoRun run(const Scene& scene, RigVolume volume, Engine& engine, RigEdits* edits, Progress& progress,
                             const BeforeFirstTick& before_first_tick);
  // Its threads end; the device was told to exert no force. What the device says of the run, if a person holds it.
  [[nodiscard]] std::optional<RunDevice> letGo();
  // After letGo(), where the scene is recorded.
  [[nodiscard]] const std::optional<Recording>& recording() const noexcept { return recording_; }

 private:
  void makeHere(const Scene& scene, const TouchPlace& place);
  void makeThere(const Scene& scene, const TouchPlace& place, Engine& engine);
  void chooseContact(const Scene& scene, const TouchPlace& place, const std::optional<Placement>& placement,
                     const std::optional<RecordedContact>& session);
  [[nodiscard]] const Device& device() const { return remote_ ? remote_->device() : *device_; }

  std::string held_;                     // kind of the device, if a person holds it
  std::optional<ServoProcess> process_;  // with --service
  std::unique_ptr<RemoteServo> remote_;  // its servo
  std::unique_ptr<Device> device_;       // without
  RecordingDevice* recorder_ = nullptr;  // device_, if the session is recorded
  RecordedContact contact_;
  std::vector<std::string> warnings_;
  std::optional<Recording> recording_;
};

}  // namespace palpate
