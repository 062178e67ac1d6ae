// SPDX-License-Identifier: Apache-2.0
// apps/report/touch_run.hpp: all data of a finished run, for the trace, the summary, the report and the picture.
//
// Plain data, filled by the job that ran; SI units, world frame W. An empty string or list means unknown or none.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/report/machine_facts.hpp"
#include "apps/scene/scene.hpp"
#include "base/measured.hpp"
#include "engine/gpu/gpu_use.hpp"
#include "servo/loop/contact_stability.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct RunVolume {
  std::string name;                 // as the user gave it
  std::string format;               // "NRRD", "DICOM series", "phantom", ...
  Vec3i size = Vec3i::Zero();       // [voxel]
  Vec3 spacing_m = Vec3::Zero();    // [m]
  double minimum = 0, maximum = 0;  // [density]
  double isovalue = 0;              // that was used [density]
};

struct VulkanFacts {
  std::string device, driver, api_version;
};

// What the run had done, as counted while it ran.
struct RunWork {
  gpu::GpuUse gpu = {};
  std::vector<std::string> threads = {};  // names of those that the process had while the servo ran
};

// A device that a person held.
struct RunDevice {
  std::string kind;       // "polhem-v1"
  std::string force_off;  // why it exerted no force at the end: "uncalibrated"; "none": it did
  std::vector<std::pair<std::string, double>> figures = {};  // what it counted: Device::figures()
};

struct RunFault {
  std::string name;             // of the flag: "stale_window"
  std::int64_t ticks = 0;       // number of ticks in which it was raised
  std::int64_t first_tick = 0;  // first tick in which it was raised
  std::string text;             // what happened, in words
  std::string effect;           // what it does to the force: "falls to zero ..."
  std::string remedy;           // what to do
};

// How far the haptic algorithm was from the exact surface, where one is known (phantoms).
struct ExactErrors {
  // Distance of the surface point that was found (the VHIP before effects) from the exact surface [voxel]. Empty if the
  // algorithm has no VHIP.
  std::optional<double> vhip_median_voxel, vhip_p99_voxel;
  double force_angle_median_deg = 0, force_angle_p99_deg = 0;  // force against the exact normal [deg]
  std::int64_t ticks = 0;                                      // number of ticks that count
  bool slide_only = false;                                     // all of these ticks are in the slide
  // Error of the spring's force (apps/touch/force_error.hpp) [N]. Empty where no exact surface point is known.
  std::optional<double> force_error_median_N = {}, force_error_p99_N = {};
};

// What the tool changed, in a run with a brush.
struct RunEdits {
  std::uint64_t count = 0;                         // edits
  std::uint64_t published = 0;                     // edits that reached the window
  std::vector<double> edit_to_window_ms;           // for each of these, the time to the published window [ms]
  std::uint64_t journal_records = 0;               // given to the journal
  std::uint64_t journal_saved = 0;                 // on disk
  std::uint64_t journal_bytes = 0;                 // on disk; 0: there is no journal [byte]
  std::string journal_failure;                     // why records are not on disk; empty: all are
  std::uint64_t refused = 0;                       // edits that the engine did not apply
  std::uint64_t saves = 0;                         // successful saves of the volume
  std::uint64_t save_failures = 0;                 // failed saves
  std::uint64_t save_bytes = 0;                    // of the newest file [byte]
  std::optional<std::uint64_t> save_version = {};  // edit version in it
  std::vector<double> save_s = {};                 // time that each successful save took [s]
  std::string save_failure = {};                   // why the newest save failed; empty: it did not
  // Of the edited volume; empty if the device failed, since the volume is then unknown.
  std::optional<std::uint64_t> content = {};  // contentHash()
  std::optional<double> added_m3 = {};        // growth of the object; negative: removed [m^3]
};

struct TouchRun {
  Scene scene;  // what was asked for
  RunVolume volume;
  MachineFacts machine;
  VulkanFacts vulkan;
  std::string commit;             // of the program
  std::string command;            // command line that repeats the run
  std::vector<StageTime> stages;  // in order
  std::vector<MemoryFigure> memory;
  std::vector<std::string> plan;                   // what was done, what was left out and what that saved
  std::vector<std::string> realtime;               // which real-time settings the system allowed
  std::vector<std::string> notes;                  // what differs from the request
  std::vector<std::vector<Vec3>> object_outlines;  // lines that show the objects on the picture [m]
  std::vector<PathPhase> phases;                   // of the path; empty for a path from a file
  std::vector<TickRecord> records;                 // one a tick, in order
  double start_to_first_tick_s = 0;                // from the process's start until the first tick was due
  std::vector<std::string> libraries;              // that the process had loaded at the end (base/mapped_libraries.hpp)
  RunWork work;
  // Simulated clock: mean time that a tick took this machine, with the engine's work before it [us].
  std::optional<double> loop_us_a_tick = {};
  std::int64_t grid_points = 0;       // ticks that were run or left out; 0: as many as records
  std::optional<RunFigures> figures;  // of the records, once these are whole; see figuresOf()
  ContactStability stability;         // of the contact in the records
  std::vector<RunFault> faults;
  std::string ended_early;         // "stopped by the user after 1.2 s of 5 s"; empty: it ended as planned
  std::vector<std::string> files;  // written or to be written, as shown to the user
  std::optional<ExactErrors> exact;
  std::optional<RunEdits> edits;
  std::optional<RunDevice> device = {};
};

// `run.figures`; computed where it is empty.
[[nodiscard]] inline RunFigures figuresOf(const TouchRun& run) {
  return run.figures ? *run.figures : computeFigures(run.records, run.scene.rate_hz, run.grid_points);
}

// Whether trace.csv is written. A run that was stopped leaves a long one out: its rows take seconds to write.
[[nodiscard]] inline bool writesTrace(const TouchRun& run) {
  const bool is_long = run.records.size() > static_cast<std::size_t>(run.scene.stopped_trace_ticks);
  return run.scene.trace && (run.ended_early.empty() || !is_long);
}

}  // namespace palpate
