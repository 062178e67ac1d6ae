// SPDX-License-Identifier: Apache-2.0
// servo/devices/recording.hpp: what a device and the servo said to each other, tick by tick, and its form as bytes.
//
// docs/recording.md has the form. Values are kept to the bit. Set-up code; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "servo/devices/device.hpp"

namespace palpate {

// One read() of the device, and what followed until the next.
struct RecordedTick {
  std::int32_t elapsed_ticks = 0;  // grid periods since the last one
  bool answered = false;           // read() gave a position
  bool pressed = false;            // the handle's switch
  bool leapt = false;              // the tool was put there, and did not go there
  bool taken = true;               // write() took the force
  bool held_differs = false;       // held() was another force than the one that was written
  ForceOff force_off = ForceOff::kNone;
  CalibrationRefusal refused = CalibrationRefusal::kNone;
  Vec3 position_W = Vec3::Zero();  // [m]
  std::int64_t report_age_ns = 0;  // [ns]
  DeviceBoundary boundary = {};
  Vec3 held_W = Vec3::Zero();  // if held_differs [N]
};

// What the session's surface was like: a device that is held may have brought it.
struct RecordedContact {
  double stiffness_N_per_m = 0;  // K [N/m]
  double damping_Ns_per_m = 0;   // B [N s/m]
};

struct Recording {
  std::string device;  // its name
  double rate_hz = 0;  // of the servo [Hz]
  RecordedContact contact = {};
  DeviceLimits limits = {};
  std::vector<HandParameters> hands = {};
  std::vector<RecordedTick> ticks = {};
  std::string damage =
      {};  // of its bytes: what is wrong with them, and where; what is before that was read. Empty: whole

  // Of the servo's grid, from the first tick to the last [tick].
  [[nodiscard]] std::int64_t gridTicks() const noexcept;
};

// With which a recording begins, of whatever version.
inline constexpr std::string_view kRecordingBegin = "PALPREC";

[[nodiscard]] std::string recordingBytes(const Recording& recording);

// Of bytes that end early or are damaged in a block, what comes before, with the damage: ticks are differences, so
// nothing after it can be read. Throws Error(kBadInput): no recording, one of another version, a header that is damaged
// or has values that no device has, or no tick.
[[nodiscard]] Recording readRecording(std::string_view bytes, const std::string& name);

}  // namespace palpate
