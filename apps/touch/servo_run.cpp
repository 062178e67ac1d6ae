// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/servo_run.hpp"

#include <chrono>
#include <thread>

#include "apps/console/interrupt.hpp"
#include "apps/touch/rig_settings.hpp"
#include "apps/touch/servo_setup.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

LoopResult runSimulated(TouchRig& rig, double ticks, Progress& progress) {
  return rig.runSimulated({}, [&](std::int64_t tick, std::int64_t) {
    if (interrupted()) rig.requestStop();  // at every tick: one with an edit may take long
    if (tick % 256 == 0) progress.fraction(static_cast<double>(tick) / ticks);
  });
}

LoopResult runReal(TouchRig& rig, double duration_s, Progress& progress) {
  const Stopwatch watch;
  rig.start();
  while (rig.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    progress.fraction(std::min(1.0, watch.seconds() / duration_s));
    if (interrupted()) rig.requestStop();
  }
  return rig.wait();
}

}  // namespace

LoopResult runServo(const Scene& scene, RigVolume volume, const Path& path, Engine& engine, RigEdits* edits,
                    Progress& progress, const std::function<void()>& before_first_tick) {
  const LoopParameters parameters = loopParameters(scene);
  const std::unique_ptr<Device> device = makeDevice(scene.device, deviceSetup(scene, path));
  TouchRig rig(engine, *device, parameters, std::move(volume), rigSettings(scene, engine.isovalue()), edits);
  before_first_tick();
  if (scene.simulated_clock) return runSimulated(rig, static_cast<double>(parameters.ticks), progress);
  return runReal(rig, scene.duration_s, progress);
}

}  // namespace palpate
