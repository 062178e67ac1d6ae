// SPDX-License-Identifier: Apache-2.0
// apps/doctor/trial.hpp: the servo's clock and a device for some seconds, without force.
//
// A thread of its own wakes at every tick, as the servo does, reads the device and tells it to exert nothing. Blocks
// for `seconds`; Ctrl-C ends it (Error(kCancelled)).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "servo/devices/device.hpp"

namespace palpate {

struct TrialFigures {
  double rate_hz = 0, seconds = 0;
  double late_p50_us = 0, late_p99_us = 0, late_max_us = 0;  // after a tick was due [us]
  double skipped_share = 0;                                  // of ticks that were a whole period late [-]
  bool fifo = false, memory_locked = false;                  // what the system granted the thread
  // of a device, if there is one
  double reports_per_s = 0;
  double failed_share = 0;  // of ticks in which it gave no position [-]
  double motion_m = 0;      // the way between the ends of what its handle went, along the longest axis [m]
  std::vector<DeviceFigure> figures = {};
  ForceOff force_off = ForceOff::kNone;
};

[[nodiscard]] TrialFigures tryServo(Device* device, double rate_hz, double seconds,
                                    const std::function<void(double share)>& progress);

}  // namespace palpate
