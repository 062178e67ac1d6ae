// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <utility>
#include <vector>

#include "servo/devices/entries.hpp"
#include "servo/devices/parameter_rows.hpp"
#include "servo/devices/polhem_device.hpp"

namespace palpate {
namespace {

using Arm = PolhemParameters;

template <std::size_t kJoint, auto kMember>
struct JointPlace {
  static constexpr auto& of(auto& arm) { return arm.joints[kJoint].*kMember; }
};
template <std::size_t kJoint>
struct HomePlace {
  static constexpr auto& of(auto& arm) { return arm.home_counts[kJoint]; }
};
template <std::size_t kJoint>
struct LowestPlace {
  static constexpr auto& of(auto& arm) { return arm.lowest_rad[kJoint]; }
};
template <std::size_t kJoint>
struct HighestPlace {
  static constexpr auto& of(auto& arm) { return arm.highest_rad[kJoint]; }
};
template <int kAxis>
struct OriginPlace {
  static constexpr auto& of(auto& arm) { return arm.origin_m[kAxis]; }
};
template <class Place>
constexpr ParameterRow<Arm> row(std::string_view key, std::string_view unit, double lowest, double highest,
                                std::string_view help) {
  return placeRow<Arm, Place>(key, unit, lowest, highest, help);
}

constexpr double kHalfTurn = std::numbers::pi;

// clang-format off
constexpr ParameterRow<Arm> kPolhemRows[] = {
    memberRow<Arm, &Arm::report_bytes>("report_bytes", "bytes", 14, 64, "size of its reports: 14, or 64 on Teensy boards"),
    memberRow<Arm, &Arm::current_limit_A>("current_limit_A", "A", 0, 20, "what its firmware's amplifiers bear; 0: not known, and forces stay off"),
    memberRow<Arm, &Arm::continuous_current_A>("continuous_current_A", "A", 0, 20, "what its motors and amplifiers bear for ever, less than the limit; 0: as much"),
    memberRow<Arm, &Arm::heating_s>("heating_s", "s", 0, 1000, "time constant with which they heat above it; 0: none, needed with it"),
    memberRow<Arm, &Arm::force_limit_N>("force_limit_N", "N", 0, 1000, "largest force at the handle"),
    memberRow<Arm, &Arm::slew_limit_N_per_s>("slew_limit_N_per_s", "N/s", 0, 1e9, "fastest change of force, 0: not stated"),
    memberRow<Arm, &Arm::stiffness_limit_N_per_m>("stiffness_limit_N_per_m", "N/m", 0, 1e6, "stiffest wall that its maker states, 0: not stated"),
    memberRow<Arm, &Arm::workspace_radius_m>("workspace_radius_m", "m", 1e-3, 10, "radius of its workspace"),
    memberRow<Arm, &Arm::mass_kg>("mass_kg", "kg", 1e-4, 100, "mass at the handle"),
    memberRow<Arm, &Arm::damping_Ns_per_m>("damping_Ns_per_m", "N s/m", 0, 1e4, "viscous friction at the handle"),
    row<JointPlace<0, &ArmJoint::capstan_m>>("capstan_a_m", "m", 1e-4, 1, "diameter of capstan a"),
    row<JointPlace<0, &ArmJoint::body_m>>("body_a_m", "m", 1e-3, 1, "diameter of the sector that capstan a drives"),
    row<JointPlace<0, &ArmJoint::length_m>>("length_a_m", "m", 1e-3, 10, "height of the axes of b and c over the foot"),
    row<JointPlace<0, &ArmJoint::torque_Nm_per_A>>("torque_a_Nm_per_A", "Nm/A", 1e-4, 100, "torque constant of motor a"),
    row<JointPlace<0, &ArmJoint::counts_per_turn>>("counts_a", "counts", 1, 1e6, "counts of encoder a for a turn of its motor"),
    row<JointPlace<0, &ArmJoint::aligned>>("aligned_a", "", 0, 1, "1: motor a points along its body's axis; 0: against it"),
    row<HomePlace<0>>("home_a", "counts", -32767, 32767, "what encoder a counts in the home position"),
    row<LowestPlace<0>>("lowest_a_rad", "rad", -kHalfTurn, kHalfTurn, "lowest angle of body a, of a calibrated arm"),
    row<HighestPlace<0>>("highest_a_rad", "rad", -kHalfTurn, kHalfTurn, "highest angle of body a"),
    row<OriginPlace<0>>("origin_x_m", "m", -10, 10, "middle of the workspace from the foot, to the user"),
    row<JointPlace<1, &ArmJoint::capstan_m>>("capstan_b_m", "m", 1e-4, 1, "diameter of capstan b"),
    row<JointPlace<1, &ArmJoint::body_m>>("body_b_m", "m", 1e-3, 1, "diameter of the sector that capstan b drives"),
    row<JointPlace<1, &ArmJoint::length_m>>("length_b_m", "m", 1e-3, 10, "length of link b"),
    row<JointPlace<1, &ArmJoint::torque_Nm_per_A>>("torque_b_Nm_per_A", "Nm/A", 1e-4, 100, "torque constant of motor b"),
    row<JointPlace<1, &ArmJoint::counts_per_turn>>("counts_b", "counts", 1, 1e6, "counts of encoder b for a turn of its motor"),
    row<JointPlace<1, &ArmJoint::aligned>>("aligned_b", "", 0, 1, "1: motor b points along its body's axis; 0: against it"),
    row<HomePlace<1>>("home_b", "counts", -32767, 32767, "what encoder b counts in the home position"),
    row<LowestPlace<1>>("lowest_b_rad", "rad", -kHalfTurn, kHalfTurn, "lowest angle of body b, of a calibrated arm"),
    row<HighestPlace<1>>("highest_b_rad", "rad", -kHalfTurn, kHalfTurn, "highest angle of body b"),
    row<OriginPlace<1>>("origin_y_m", "m", -10, 10, "middle of the workspace from the foot, to the right"),
    row<JointPlace<2, &ArmJoint::capstan_m>>("capstan_c_m", "m", 1e-4, 1, "diameter of capstan c"),
    row<JointPlace<2, &ArmJoint::body_m>>("body_c_m", "m", 1e-3, 1, "diameter of the sector that capstan c drives"),
    row<JointPlace<2, &ArmJoint::length_m>>("length_c_m", "m", 1e-3, 10, "length of link c"),
    row<JointPlace<2, &ArmJoint::torque_Nm_per_A>>("torque_c_Nm_per_A", "Nm/A", 1e-4, 100, "torque constant of motor c"),
    row<JointPlace<2, &ArmJoint::counts_per_turn>>("counts_c", "counts", 1, 1e6, "counts of encoder c for a turn of its motor"),
    row<JointPlace<2, &ArmJoint::aligned>>("aligned_c", "", 0, 1, "1: motor c points along its body's axis; 0: against it"),
    row<HomePlace<2>>("home_c", "counts", -32767, 32767, "what encoder c counts in the home position"),
    row<LowestPlace<2>>("lowest_c_rad", "rad", -kHalfTurn, kHalfTurn, "lowest angle of body c, of a calibrated arm"),
    row<HighestPlace<2>>("highest_c_rad", "rad", -kHalfTurn, kHalfTurn, "highest angle of body c"),
    row<OriginPlace<2>>("origin_z_m", "m", -10, 10, "middle of the workspace from the foot, up"),
};
// clang-format on

std::unique_ptr<Device> makePolhem(const DeviceSetup& setup) {
  std::vector<Arm> look_alikes;
  for (const DeviceValues& values : setup.look_alikes) look_alikes.push_back(polhemParametersOf(values));
  const PolhemUse use{.simulated_clock = setup.simulated_clock,
                      .rate_hz = setup.rate_hz,
                      .calibrated = setup.calibrated,
                      .motors_checked = setup.motors_checked,
                      .look_alikes = std::move(look_alikes),
                      .thread_begins = setup.thread_begins};
  return std::make_unique<PolhemDevice>(polhemParametersOf(setup.values), use, setup.open);
}

}  // namespace

PolhemParameters polhemParametersOf(const DeviceValues& values) {
  return given<Arm>(kPolhemRows, {.values = values});
}

DeviceEntry polhemEntry() {
  return {.name = "polhem-family",
          .description = "WoodenHaptics and Polhem over HID: force in three directions",
          .needs_port = true,
          .parameters = parametersOf<kPolhemRows>,
          .make = makePolhem,
          .check = [](const DeviceValues& values) { checkPolhem(polhemParametersOf(values)); }};
}

}  // namespace palpate
