// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/servo_run.hpp"

#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/servo_setup/contact_bounds.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/local_servo.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/thread_names.hpp"
#include "base/units.hpp"
#include "servo/loop/real_time.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {
namespace {

double ticksOf(const Scene& scene) {
  return std::round(scene.duration_s * scene.rate_hz);
}

// Adds up the time between its stops: what a tick and the engine's work before the next one take.
class TickTimer {
 public:
  void stop() {
    if (begun_) ns_ += monotonicNow_ns() - begin_ns_;
    ticks_ += begun_ ? 1 : 0;
  }
  void go() {
    begin_ns_ = monotonicNow_ns();
    begun_ = true;
  }
  [[nodiscard]] std::optional<double> mean_us() const {
    if (ticks_ == 0) return std::nullopt;
    return 1e6 / kNanosecondsPerSecond * static_cast<double>(ns_) / static_cast<double>(ticks_);
  }

 private:
  std::int64_t begin_ns_ = 0, ns_ = 0, ticks_ = 0;
  bool begun_ = false;
};

ServoRun runSimulated(TouchRig& rig, double ticks, Progress& progress) {
  std::int64_t first_ns = 0;
  TickTimer timer;
  ServoRun run{.loop = {}, .threads = threadNames()};
  run.loop = rig.runSimulated({}, [&](std::int64_t tick, std::int64_t) {
    timer.stop();
    if (tick == 0) first_ns = monotonicNow_ns();
    if (interrupted()) rig.requestStop();  // at every tick: one with an edit may take long
    if (tick % 256 == 0) progress.fraction(static_cast<double>(tick) / ticks);
    timer.go();
  });
  run.loop.first_due_ns = first_ns;
  run.loop_us_a_tick = timer.mean_us();
  return run;
}

ServoRun runReal(TouchRig& rig, double duration_s, Progress& progress) {
  const Stopwatch watch;
  rig.start();
  std::vector<std::string> threads = threadNames();  // also of a run that is over before it is looked at
  for (bool is_first = true; rig.running(); is_first = false) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (is_first && rig.running()) threads = threadNames();
    progress.fraction(std::min(1.0, watch.seconds() / duration_s));
    if (interrupted()) rig.requestStop();
  }
  return {.loop = rig.wait(), .threads = std::move(threads)};
}

}  // namespace

double recordBytes(const Scene& scene) {
  return 2 * ticksOf(scene) * sizeof(TickRecord);
}

void checkRunLength(const Scene& scene, std::uint64_t available_bytes) {
  const std::string input = scene.path_file.empty()
                                ? fmt::format("--seconds {:g} at --rate {:g}", scene.duration_s, scene.rate_hz)
                                : fmt::format("{} at --rate {:g}", scene.path_file, scene.rate_hz);
  if (!(ticksOf(scene) >= 1)) {
    throw Error(Error::Code::kBadInput, input, "the run has no tick", "make it longer or the rate higher");
  }
  const double bytes = recordBytes(scene);
  const auto available = static_cast<double>(available_bytes);
  if (bytes <= available) return;
  constexpr double kBytesPerGiB = 1073741824.0;
  throw Error(Error::Code::kOutOfMemory, input,
              fmt::format("a run of {:.3g} s records {:.3g} ticks, which need {:.3g} GiB, and {:.3g} GiB are free",
                          scene.duration_s, ticksOf(scene), bytes / kBytesPerGiB, available / kBytesPerGiB),
              "make it shorter or the rate lower");
}

ServoRun runServo(const Scene& scene, RigVolume volume, Device& device, Engine& engine, RigEdits* edits,
                  Progress& progress, const BeforeFirstTick& before_first_tick) {
  LocalServo servo(device, engine.exchange());
  return runServo(scene, std::move(volume), servo, engine, edits, progress, before_first_tick);
}

ServoRun runServo(const Scene& scene, RigVolume volume, ServoSide& servo, Engine& engine, RigEdits* edits,
                  Progress& progress, const BeforeFirstTick& before_first_tick) {
  const LoopParameters parameters = loopParameters(scene);
  const RigSettings settings = rigSettings(scene, engine.isovalue());
  TouchRig rig(engine, servo, parameters, std::move(volume), settings, edits);
  before_first_tick(boundWarnings(settings, parameters, servo.device()));
  ServoRun run = scene.simulated_clock ? runSimulated(rig, static_cast<double>(parameters.ticks), progress)
                                       : runReal(rig, scene.duration_s, progress);
  run.most_damping_Ns_per_m = renderableDamping(settings, parameters, servo.device());
  return run;
}

}  // namespace palpate
