// SPDX-License-Identifier: Apache-2.0
// servo/devices/polhem_device.hpp: WoodenHaptics and Polhem over reports: positions from encoders, forces as currents.
//
// When it exerts no force:
// - Before it is calibrated. Its encoders count from where it was when it was switched on, so its handle must be put
//   into the home position once (home_calibration.hpp). After it was unplugged it must be calibrated again.
// - Before the current limit is given. Two firmwares with the same USB numbers drive amplifiers of 3 A and of 6 A; a
//   current above that of the amplifiers saturates them.
// - While it is not there. The firmware keeps no currents when no report has come for 0.5 s. That protects the hand
//   from a program that died, and from a cable that is pulled while the arm has power of its own.
//
// Motors that nobody has checked:
// - Swapped leads or plugs, and another arm than its user says, look right in every position.
// - So until somebody has checked the motors (motor_check.hpp) no force is more than kUncheckedForce_N at the handle,
//   whichever arm with these reports it is, and however its motors are plugged (look_alikes.hpp).
// - The pushes of the check itself keep to that, to the force limit, the current limit and the heat of the motors.
//
// Reports that are refused:
// - What is no report, and a position that no hand can reach in the time (believed_counts.hpp). It is counted, and not
//   used.
// - Three such positions in a row: the arm counts from elsewhere, and is not calibrated any more.
// - After 0.5 s without a usable report the arm may have been switched off and on: it is not calibrated any more.
//
// Calibration, by its button or by a program, and why it may be refused: home_calibration.hpp.
//
// Pace: a force waits for the next report, so the pace of the reports, measured when the device is opened, is its
// delay. Frame D, the device's: x to the right, y up, z towards the user, 0 in the middle of the workspace [m, N];
// placed_device.hpp puts it into the world. Threads as in device.hpp. By the simulated clock elapse() exchanges reports
// itself, and so waits for the device.
#pragma once

#include <atomic>
#include <cstdint>
#include <numbers>

#include "servo/devices/arm_kinematics.hpp"
#include "servo/devices/believed_counts.hpp"
#include "servo/devices/current_heat.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/home_calibration.hpp"
#include "servo/devices/jointed_arm.hpp"
#include "servo/devices/look_alikes.hpp"
#include "servo/devices/polhem_report.hpp"
#include "servo/devices/registry.hpp"
#include "servo/devices/report_link.hpp"

namespace palpate {

// Polhem v1's (arm_kinematics.hpp names the source); mass and friction at the handle are guesses, as nobody has
// published a measurement.
struct PolhemParameters {
  int report_bytes = 14;  // 64 on Teensy boards
  std::array<ArmJoint, 3> joints = {ArmJoint{0.010, 0.180, 0.058, 0.0538, 2000, true},
                                    ArmJoint{0.010, 0.100, 0.174, 0.0538, 2000, true},
                                    ArmJoint{0.010, 0.100, 0.133, 0.0538, 2000, true}};
  Vec3 origin_m = {0.14, 0, 0.1};
  std::array<int, 3> home_counts = {0, 0, -5000};  // what encoders a to c count in the home position
  double current_limit_A = 0;                      // of the firmware; 0: not given, and forces stay off
  double continuous_current_A = 0;                 // that motors and amplifiers bear for ever; 0: as much as the limit
  double heating_s = 0;                            // time constant of their heating; 0: none is given
  double force_limit_N = 5;
  double slew_limit_N_per_s = 0;  // 0: not stated
  double stiffness_limit_N_per_m = 800;
  double workspace_radius_m = 0.1;
  double mass_kg = 0.15, damping_Ns_per_m = 0.5;
  // What its joints can be turned to; a half turn: not stated [rad].
  std::array<double, 3> lowest_rad = {-std::numbers::pi, -std::numbers::pi, -std::numbers::pi};
  std::array<double, 3> highest_rad = {std::numbers::pi, std::numbers::pi, std::numbers::pi};
};

// Those of a kind in the table of devices, by their keys; what is not given has its usual value. Set-up code.
[[nodiscard]] PolhemParameters polhemParametersOf(const DeviceValues& values);

// Throws Error(kBadInput) for parameters that no arm can have.
void checkPolhem(const PolhemParameters& parameters);

struct PolhemUse {
  bool simulated_clock = false;
  double rate_hz = 1000;    // of the servo [Hz]
  bool calibrated = false;  // since it was switched on
  bool motors_checked = false;
  std::vector<PolhemParameters> look_alikes = {};
  int answer_ms = 10;  // an answer that takes longer counts as lost [ms]
  std::function<void()> thread_begins = {};
};

class PolhemDevice final : public Device, private JointedArm {
 public:
  // Waits for the first report and, by the real clock, for the pace of the next ones, 0.2 s at most. Throws Error: as
  // `open` does; kDevice if no report comes, or none that is a Polhem's, or if they come too slowly for this rate.
  PolhemDevice(const PolhemParameters& parameters, const PolhemUse& use, PortOpener open);

  [[nodiscard]] std::string_view name() const noexcept override { return "Polhem"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] std::vector<HandParameters> hands() const override;
  [[nodiscard]] ForceOff forceOff() const noexcept override;
  [[nodiscard]] std::vector<DeviceFigure> figures() const override;
  void elapse(int ticks) noexcept override;
  [[nodiscard]] bool read(Vec3& position_D) noexcept override;
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override;
  [[nodiscard]] CalibrationRefusal refusedCalibration() const noexcept override;
  [[nodiscard]] bool pressed() const noexcept override { return pressed_; }
  [[nodiscard]] bool write(const Vec3& force_D) noexcept override;
  [[nodiscard]] Vec3 held(const Vec3& force_D) const noexcept override;

  [[nodiscard]] JointedArm* arm() noexcept override { return this; }
  [[nodiscard]] CalibrationRefusal calibrate() noexcept override;
  // What calibrate() would say now.
  [[nodiscard]] CalibrationRefusal whyNotCalibrate() const noexcept;
  [[nodiscard]] const ArmCounts& counts() const noexcept { return believed_.counts(); }

 private:
  void take(const Received& received) noexcept;
  void measurePace();
  [[nodiscard]] int delayTicks() const noexcept;
  void tell(HomeCalibration::Order order) noexcept;
  [[nodiscard]] double time_s() const noexcept;
  [[nodiscard]] double reportTime_s() const noexcept;
  [[nodiscard]] double silence_s() const noexcept;
  [[nodiscard]] bool isThere() const noexcept;
  [[nodiscard]] BelievedCounts::Interval intervalTo(const Received& received) const noexcept;
  [[nodiscard]] bool isHome(const PolhemCounts& raw) const noexcept;
  [[nodiscard]] double sinceWrite_s() noexcept;
  void passHeat() noexcept;
  [[nodiscard]] double forceLimit_N() const noexcept;
  [[nodiscard]] double allowedShare(const Vec3& currents_A, double force_N, double limit_N) const noexcept;
  [[nodiscard]] Vec3 currentsFor(const Vec3& force_D, double& share) const noexcept;
  [[nodiscard]] double trialCurrent_A_per_N(int motor) const noexcept;
  [[nodiscard]] double trialLimit_N(int motor) const noexcept;
  void post(const Vec3& currents_A, double force_N) noexcept;

  [[nodiscard]] Vec3 angles() const noexcept override { return believed_.angles(); }
  [[nodiscard]] Vec3 counts_rad() const noexcept override;
  [[nodiscard]] bool canBeTried() const noexcept override;
  [[nodiscard]] Vec3 levers_m() const noexcept override;
  [[nodiscard]] double mass_kg() const noexcept override { return parameters_.mass_kg; }
  [[nodiscard]] double damping_Ns_per_m() const noexcept override { return parameters_.damping_Ns_per_m; }
  double push(int motor, double force_N) noexcept override;

  PolhemParameters parameters_;
  PolhemUse use_;
  ArmKinematics arm_;
  LookAlikes look_alikes_;                                    // itself first
  std::atomic<std::uint64_t> garbage_{0}, garbage_bytes_{0};  // counted by the link's thread; of the last one
  ReportLink link_;
  std::uint64_t seen_ = 0;
  std::atomic<std::uint64_t> connection_{0};  // of the last report that counted
  std::int64_t received_ns_ = 0;              // when the last report that counted came
  std::int64_t asked_ns_ = 0;                 // since when that may have been so
  std::int64_t silent_ns_ = 0;                // how long the link had heard nothing in all until then
  bool was_unasked_ = false;                  // it came of its own accord
  double report_period_s_ = 0;                // measured at the start; 0: by the simulated clock, or nothing came [s]
  int silent_ticks_ = 0;                      // simulated clock: since the last report that counted
  std::int64_t ticks_ = 0;                    // simulated clock: since the start
  bool pressed_ = false;                      // the handle's switch
  BelievedCounts believed_;
  HomeCalibration calibration_;
  CurrentHeat heat_;
  Vec3 flowing_A_ = Vec3::Zero();  // since the last write
  std::int64_t written_ns_ = 0;    // when that was; by the simulated clock unused
  int ticks_since_write_ = 0;      // simulated clock
  std::atomic<std::uint64_t> implausible_{0};
};

}  // namespace palpate
