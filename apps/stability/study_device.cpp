// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/study_device.hpp"

#include "servo/devices/registry.hpp"

namespace palpate {
namespace {

StudyDevice defaultDevice() {
  const auto usual = [](const char* key) { return deviceParameter(devices().front().name, key).usual; };
  return {.name = "simulated",
          .kind = "the default device: no encoders, no delay",
          .mass_kg = usual("mass_kg"),
          .damping_Ns_per_m = usual("damping_Ns_per_m"),
          .coulomb_friction_N = 0,
          .force_limit_N = usual("force_limit_N"),
          .resolution_m = usual("encoder_resolution_m"),
          .delay_ticks = static_cast<int>(usual("delay_ticks"))};
}

}  // namespace

const std::vector<StudyDevice>& studyDevices() {
  static const std::vector<StudyDevice> kDevices = {
      defaultDevice(),
      {"stylus-arm", "a small arm with a stylus, driven by cables", 0.045, 0.05, 0.26, 3.3, 55e-6, 1},
      {"parallel", "a parallel mechanism", 0.2, 0.5, 0.2, 12, 10e-6, 0},
      {"open-arm", "an arm that its users build", 0.12, 0.1, 0.05, 5, 54e-6, 1},
      {"light-arm", "a light laboratory arm", 0.03, 0.02, 0.04, 8.5, 30e-6, 0}};
  return kDevices;
}

HandParameters bare(const StudyDevice& device) {
  return {.hand_mass_kg = 0,
          .hand_damping_Ns_per_m = 0,
          .hand_stiffness_N_per_m = 0,
          .device_mass_kg = device.mass_kg,
          .device_damping_Ns_per_m = device.damping_Ns_per_m};
}

SimulatedDeviceParameters held(const StudyDevice& device, const HandParameters& with_hand) {
  SimulatedDeviceParameters parameters;
  parameters.hand = Hand::kSpring;
  parameters.dynamics = with_hand;
  parameters.force_limit_N = device.force_limit_N;
  parameters.encoder_resolution_m = device.resolution_m;
  parameters.delay_ticks = device.delay_ticks;
  return parameters;
}

PassiveDevice passiveDevice(const StudyDevice& device, double rate_hz) {
  return {.damping_Ns_per_m = device.damping_Ns_per_m,
          .coulomb_friction_N = device.coulomb_friction_N,
          .resolution_m = device.resolution_m,
          .rate_hz = rate_hz};
}

}  // namespace palpate
