// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/entries.hpp"
#include "servo/devices/parameter_rows.hpp"
#include "servo/devices/simulated_device.hpp"

namespace palpate {
namespace {

using Simulated = SimulatedDeviceParameters;

// clang-format off
constexpr ParameterRow<Simulated> kSimulatedRows[] = {
    {"spring_hand", "", 0, 1, "0: the device is exactly on the path; 1: a hand pulls it and feels the force",
     [](const Simulated& p) { return p.hand == Hand::kSpring ? 1.0 : 0.0; }, [](Simulated& p, double v) { p.hand = v > 0 ? Hand::kSpring : Hand::kRigid; }},
    {"hand_mass_kg", "kg", 0, 100, "mass of the spring hand",
     [](const Simulated& p) { return p.dynamics.hand_mass_kg; }, [](Simulated& p, double v) { p.dynamics.hand_mass_kg = v; }},
    {"hand_damping_Ns_per_m", "N s/m", 0, 1e4, "damping of the spring hand",
     [](const Simulated& p) { return p.dynamics.hand_damping_Ns_per_m; }, [](Simulated& p, double v) { p.dynamics.hand_damping_Ns_per_m = v; }},
    {"hand_stiffness_N_per_m", "N/m", 0, 1e5, "stiffness of the spring hand",
     [](const Simulated& p) { return p.dynamics.hand_stiffness_N_per_m; }, [](Simulated& p, double v) { p.dynamics.hand_stiffness_N_per_m = v; }},
    {"mass_kg", "kg", 1e-6, 100, "mass of the simulated device",
     [](const Simulated& p) { return p.dynamics.device_mass_kg; }, [](Simulated& p, double v) { p.dynamics.device_mass_kg = v; }},
    {"damping_Ns_per_m", "N s/m", 0, 1e4, "viscous friction of the simulated device",
     [](const Simulated& p) { return p.dynamics.device_damping_Ns_per_m; }, [](Simulated& p, double v) { p.dynamics.device_damping_Ns_per_m = v; }},
    {"force_limit_N", "N", 0, 1000, "largest force of the simulated device",
     [](const Simulated& p) { return p.force_limit_N; }, [](Simulated& p, double v) { p.force_limit_N = v; }},
    {"encoder_resolution_m", "m", 0, 10e-3, "resolution of the simulated device's encoders, 0: none",
     [](const Simulated& p) { return p.encoder_resolution_m; }, [](Simulated& p, double v) { p.encoder_resolution_m = v; }},
    {"friction_N", "N", 0, 100, "dry friction of the simulated device, along each axis",
     [](const Simulated& p) { return p.dynamics.device_friction_N; }, [](Simulated& p, double v) { p.dynamics.device_friction_N = v; }},
    {"dropped_share", "", 0, 0.99, "share of the simulated device's reports that do not come",
     [](const Simulated& p) { return p.dropped_share; }, [](Simulated& p, double v) { p.dropped_share = v; }},
    {"delay_ticks", "ticks", 0, 1000, "delay of the simulated device's force",
     [](const Simulated& p) { return static_cast<double>(p.delay_ticks); }, [](Simulated& p, double v) { p.delay_ticks = static_cast<int>(v); }},
};
// clang-format on

std::unique_ptr<Device> makeSimulated(const DeviceSetup& setup) {
  return std::make_unique<SimulatedDevice>(given<Simulated>(kSimulatedRows, setup), *setup.path, setup.rate_hz);
}

}  // namespace

DeviceEntry simulatedEntry() {
  return {.name = "simulated",
          .description = "needs no hardware: a simulated hand moves it along a path",
          .needs_path = true,
          .parameters = parametersOf<kSimulatedRows>,
          .make = makeSimulated};
}

// The same, where the path is not known before: what pulls the hand is the mouse.
DeviceEntry mouseEntry() {
  DeviceEntry entry = simulatedEntry();
  entry.name = "mouse";
  entry.description = "the pointer of a window moves the simulated device ('palpate sculpt', which begins with it)";
  entry.needs_pointer = true;
  return entry;
}

}  // namespace palpate
