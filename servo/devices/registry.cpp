// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/registry.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/nearest_word.hpp"
#include "servo/devices/simulated_device.hpp"

namespace palpate {
namespace {

// A parameter and its member of a device's `Parameters`. The usual value is the default of that member.
template <class Parameters>
struct ParameterRow {
  std::string_view key, unit;
  double lowest, highest;
  std::string_view help;
  double (*get)(const Parameters&);
  void (*set)(Parameters&, double);
};

// DeviceEntry::parameters of a device with one table of rows.
template <const auto& kRows>
std::span<const DeviceParameter> parametersOf() {
  static const auto kParameters = [] {
    std::array<DeviceParameter, std::size(kRows)> all;
    std::transform(std::begin(kRows), std::end(kRows), all.begin(), [](const auto& row) {
      return DeviceParameter{row.key, row.unit, row.get({}), row.lowest, row.highest, row.help};
    });
    return all;
  }();
  return kParameters;
}

template <class Parameters>
Parameters given(std::span<const ParameterRow<Parameters>> rows, const DeviceSetup& setup) {
  Parameters parameters;
  for (const auto& row : rows) {
    const auto value = setup.values.find(row.key);
    if (value != setup.values.end()) row.set(parameters, value->second);
  }
  return parameters;
}

// ---- the simulated device ----

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
    {"delay_ticks", "ticks", 0, 1000, "delay of the simulated device's force",
     [](const Simulated& p) { return static_cast<double>(p.delay_ticks); }, [](Simulated& p, double v) { p.delay_ticks = static_cast<int>(v); }},
};
// clang-format on

std::unique_ptr<Device> makeSimulated(const DeviceSetup& setup) {
  return std::make_unique<SimulatedDevice>(given<Simulated>(kSimulatedRows, setup), *setup.path, setup.rate_hz);
}

// ---- the table of devices ----

constexpr DeviceEntry kEntries[] = {
    {"simulated", "needs no hardware: a simulated hand moves it along a path", true, parametersOf<kSimulatedRows>,
     makeSimulated},
};

const DeviceParameter* find(const DeviceEntry& entry, std::string_view key) {
  const std::span<const DeviceParameter> all = entry.parameters();
  const auto at = std::find_if(all.begin(), all.end(), [&](const DeviceParameter& p) { return p.key == key; });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

std::span<const DeviceEntry> devices() noexcept {
  return kEntries;
}

const DeviceEntry& deviceEntry(std::string_view name) {
  std::vector<std::string> names;
  for (const DeviceEntry& entry : kEntries) {
    if (entry.name == name) return entry;
    names.emplace_back(entry.name);
  }
  refuse(formatted("device \"{}\"", name), "there is none of this name",
         withDidYouMean(name, names, formatted("choose one of {}", listed(names))));
}

const DeviceParameter& deviceParameter(std::string_view device, std::string_view key) {
  const DeviceParameter* parameter = find(deviceEntry(device), key);
  if (parameter == nullptr) throw std::logic_error(formatted("device {} has no parameter {}", device, key));
  return *parameter;
}

std::unique_ptr<Device> makeDevice(std::string_view name, const DeviceSetup& setup) {
  const DeviceEntry& entry = deviceEntry(name);
  for (const auto& [key, value] : setup.values) {
    const std::string input = formatted("{} of device {}", key, name);
    const DeviceParameter* parameter = find(entry, key);
    if (parameter == nullptr) refuse(input, "the device has no such parameter", "leave it out");
    if (value >= parameter->lowest && value <= parameter->highest) continue;
    refuse(input, formatted("{} is out of range", value),
           formatted("give {} to {}", parameter->lowest, parameter->highest));
  }
  if (entry.needs_path && setup.path == nullptr)
    refuse(formatted("device {}", name), "there is no path to lead it along", "give a path");
  return entry.make(setup);
}

}  // namespace palpate
