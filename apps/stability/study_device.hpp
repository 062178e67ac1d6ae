// SPDX-License-Identifier: Apache-2.0
// apps/stability/study_device.hpp: the devices of the stability study: the default device of the registry, and four of
// the kinds that laboratories have.
//
// Force limits and resolutions are of the size that vendors state for such devices; masses, damping and friction are
// assumed, since few state them. So a row says what a kind of device can bear, not what a product can.
// Any thread; no cost.
#pragma once

#include <vector>

#include "servo/devices/simulated_device.hpp"
#include "servo/stability/passivity_bounds.hpp"

namespace palpate {

struct StudyDevice {
  const char* name;
  const char* kind;
  double mass_kg, damping_Ns_per_m, coulomb_friction_N;
  double force_limit_N, resolution_m;
  int delay_ticks;
};

[[nodiscard]] const std::vector<StudyDevice>& studyDevices();

// Without a hand; mass and damping are the device's.
[[nodiscard]] HandParameters bare(const StudyDevice& device);
// With encoders, delay and force limit, held by a hand.
[[nodiscard]] SimulatedDeviceParameters held(const StudyDevice& device, const HandParameters& with_hand);
[[nodiscard]] PassiveDevice passiveDevice(const StudyDevice& device, double rate_hz);

}  // namespace palpate
