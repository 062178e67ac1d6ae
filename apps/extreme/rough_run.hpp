// SPDX-License-Identifier: Apache-2.0
// apps/extreme/rough_run.hpp: a run of the real servo loop on a volume in plain memory, in which clock, device and
// windows may do what they please.
//
// Simulated time: the same run gives the same ticks, bit for bit. World frame W [m, N]. One thread. Cost: some
// microsecond a tick.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "apps/sampled/sampled_volume.hpp"
#include "servo/contact/effects.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

// How windows come. The default: one around the tool in every tick that needs another, as the engine publishes them.
struct WindowManner {
  std::int64_t first_tick = 0;                                        // none before
  std::int64_t last_tick = std::numeric_limits<std::int64_t>::max();  // neither a window nor its confirmation after
  int late_ticks = 0;                                                 // a window lies where the tool was that long ago
  bool every_tick = false;  // the same window is published again in every tick
  bool whole = false;       // one window of the whole volume
  // Spoils a window before it is published; empty: no.
  std::function<void(SampleWindow& window, Sample* samples)> spoil = {};
};

struct RoughRun {
  std::shared_ptr<const SampledVolume> volume;  // null: no window ever comes
  // Volumes that replace it, each from a tick on, in the order of time: edits under the tool.
  struct Edit {
    std::int64_t tick;
    std::shared_ptr<const SampledVolume> volume;
  };
  std::vector<Edit> edits = {};
  WindowManner windows = {};

  std::string algorithm = "hri";
  AlgorithmParameters parameters = {};  // its isovalue is the volume's, its rate that of `loop`
  EffectParameters effects = {};
  ContactObjects objects = {};
  // Algorithms that take over, each from a tick on.
  struct Change {
    std::int64_t tick;
    std::string algorithm;
  };
  std::vector<Change> changes = {};

  SimulatedDeviceParameters device = {};
  std::function<Vec3(double time_s)> path_W = {};  // of the hand [m]
  // What comes between device and servo; each gets the number of the call and may be empty.
  std::function<bool(std::int64_t call, Vec3& position_W)> on_read = {};  // changes a position; false: no answer
  std::function<bool(std::int64_t call)> on_write = {};                   // false: the force is refused
  std::function<Vec3(const Vec3& force_W)> on_held = {};                  // what the device says that it holds

  LoopParameters loop = {};  // its ticks are set
  double seconds = 0.5;
  // When a sleep ends that is due at `due_ns` [ns]; empty: in time, by the simulated clock.
  std::function<std::int64_t(std::int64_t due_ns)> wake_ns = {};
};

// What the device saw, beside the records. It looks at every force that it takes, with limits of its own account.
struct Referee {
  std::int64_t forces = 0, not_finite = 0;
  double largest_N = 0;         // force
  double largest_change_N = 0;  // from one force taken to the next; the end of the run included
  Vec3 last_W = Vec3::Zero();   // force at the end of the run [N]
};

struct RoughResult {
  std::vector<TickRecord> records;
  Referee referee;
  double force_limit_N = 0, slew_per_tick_N = 0;  // that the forces had to keep
  bool released = false;

  [[nodiscard]] std::uint32_t faults() const noexcept;  // of all ticks together
  [[nodiscard]] std::int64_t contactTicks() const noexcept;
};

// Throws Error as makeAlgorithm(), SimulatedDevice and ServoLoop do.
[[nodiscard]] RoughResult play(const RoughRun& run);

}  // namespace palpate
