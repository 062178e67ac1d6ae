// SPDX-License-Identifier: Apache-2.0
// apps/doctor/diagnosis.hpp: `palpate doctor`: what is here, what is missing for forces, and what to do about it.
//
// Looks at the HID devices, the rights to use them, the device that is asked for (or the only one), the user's limits
// for real time and the Vulkan drivers, and lets the servo's clock and the device run for some seconds without force.
// Nothing is changed but what installUdevRules() installs. One thread. Takes `trial_s` and a second more.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/doctor/trial.hpp"
#include "servo/hid/hid.hpp"

namespace palpate {

struct DoctorRequest {
  std::string device;       // kind; empty: what the only device that fits can be
  std::string device_path;  // empty: the only one of its kind
  bool by_libusb = false;
  std::optional<double> current_limit_A = {};
  bool calibrated = false;
  double rate_hz = 1000;  // of the servo [Hz]
  double trial_s = 5;     // [s]
};

struct Finding {
  enum class State { kGood, kNote, kBad };  // kBad: there is no force because of it
  State state = State::kGood;
  std::string topic;   // "device"
  std::string text;    // what was found
  std::string remedy;  // what to do; empty: nothing
};

struct FoundHid {
  HidInfo device;
  std::vector<std::string> kinds;  // that it can be; empty: none that Palpate drives
  bool may_use = false;            // the user may read and write it
};

struct Diagnosis {
  std::vector<FoundHid> hid;
  std::vector<Finding> findings;
  std::optional<TrialFigures> trial;
  std::string device;  // kind that was tried; empty: none
  bool forces_on = false;
  std::string verdict;  // "forces are on" or "forces are off because ...; remedy"
};

// Throws Error: kCancelled on Ctrl-C; kBadInput for a device that nobody knows. Everything else is a finding.
[[nodiscard]] Diagnosis diagnose(const DoctorRequest& request, Progress& progress);

}  // namespace palpate
