// SPDX-License-Identifier: Apache-2.0
// apps/serve/served_status.hpp: how a service is, as figures with names, for `palpate ctl status`, `palpate top` and
// Prometheus. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "servo/devices/force_off.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

struct ServedStatus {
  bool servo = false;                               // one is there
  std::uint64_t servos = 0;                         // that have come so far
  std::int64_t servo_process = 0;                   // of the newest one; 0: none
  ToolPose pose;                                    // of the newest one; tick -1: none
  ForceOff force_off = ForceOff::kNone;             // why its device exerts none
  std::int64_t pose_at_ns = 0;                      // when it was seen (CLOCK_MONOTONIC)
  std::int64_t window_age_ns = 0;                   // of the window that its newest tick used, since it was published
  std::uint64_t windows = 0;                        // that the servo has read, as its poses say
  std::array<std::uint64_t, 32> faults_begun = {};  // by bit (servo/safety/faults.hpp): as poses were seen to show them
  std::uint64_t waiting_for_disk = 0;               // edits that are made but not on the disk
  std::uint64_t waiting = 0;                        // edits, undos, redos and saves that the engine has not begun
  std::uint64_t edits = 0, refused = 0;
  std::uint64_t undoable = 0, redoable = 0;
  bool unsaved = false;
  std::uint64_t journal_bytes = 0;
  std::string journal_failure;
  std::uint64_t lost_records = 0;  // of the journal that this service went on from
  std::uint64_t engines = 1;       // made so far
  std::uint64_t gpu_bytes = 0;     // of the engine's buffers
  std::uint64_t clients = 0;
};

// Notes a pose of a servo whose first window was `first_window`.
void notePose(ServedStatus& status, const ToolPose& pose, std::uint64_t first_window, std::int64_t now_ns);

struct StatusFigure {
  const char* key;   // of JSON; "palpate_KEY" for Prometheus
  const char* help;  // with its unit
  bool is_counter;   // else a gauge
  double (*value)(const ServedStatus& status, std::int64_t now_ns);
};

// One row for each figure; that of each fault follows from faultTable().
[[nodiscard]] std::span<const StatusFigure> statusFigures() noexcept;

// All figures by key, and "fault_NAME" for each fault that has begun.
[[nodiscard]] std::vector<std::pair<std::string, double>> figuresOf(const ServedStatus& status, std::int64_t now_ns);

// The same as Prometheus' text (exposition format 0.0.4), with help and types.
[[nodiscard]] std::string metricsText(const std::vector<std::pair<std::string, double>>& figures);

}  // namespace palpate
