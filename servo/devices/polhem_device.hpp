// SPDX-License-Identifier: Apache-2.0
// servo/devices/polhem_device.hpp: WoodenHaptics and Polhem over reports: positions from encoders, forces as currents.
//
// Encoders count from where the device was when it was switched on. So the handle must be put into its home position
// once, and the device be told to count from there: by its button, or by `palpate calibrate`. Until then, and after the
// device came back from being unplugged, it exerts no force. The firmware keeps no currents when no report has come for
// 0.5 s: that protects the hand from a program that died, and from a cable that is pulled while the arm has power of
// its own. The servo takes a device that is not there as one that holds no force.
//   Two firmwares with the same USB numbers drive amplifiers of 3 A and 6 A; a current above the amplifier's saturates
// it. So forces stay off until the limit is given.
//   Motors whose leads or plugs are swapped, and an arm that is another one than its user says, look right in every
// position. Until somebody has checked the motors (motor_check.hpp) no force is more than kUncheckedForce_N at the
// handle, as whichever of the arms with these reports it is, and however its motors are plugged. A calibrated arm whose
// joints are where this kind's cannot be is not calibrated any more.
//   A report that is none, or whose position no hand can reach in the time (hand_motion.hpp), is counted and not used.
//   If
// three in a row say so, the device counts from elsewhere: it has been switched off meanwhile, or a joint has slipped
// on its capstan. Then it is not calibrated any more, as every position would be wrong. What counts as an answer to a
// calibration came after the device was told, over the same connection. The button counts if it was seen not pressed a
// moment before, and pressed for a while (debounced_button.hpp): what was pressed at some time before, when the handle
// may have been elsewhere, makes the device uncalibrated.
//   A calibration while the arm pushes, while the handle moves, or where a calibrated arm says that it is not at home,
// is refused: it would turn the force of the next contact anywhere. The firmware has no command that forgets what its
// button asked, but one to count from given numbers. So once the handle rests without force the device is told to count
// on from what it counts: nothing changes, and the button is free. Who moves the handle within the two reports that
// this takes shifts the count by as much.
//   A device that says nothing usable for 0.5 s may have been switched off and on.
//   A force waits for the next report, so the pace of the reports, measured when the device is opened, is its delay.
// Frame D, the device's: x to the right, y up, z towards the user, 0 in the middle of the workspace [m, N].
// placed_device.hpp puts it into the world. Threads as in
// device.hpp. By the simulated clock elapse() exchanges reports itself and so waits for the device.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <numbers>

#include "servo/devices/arm_kinematics.hpp"
#include "servo/devices/calibration_refusal.hpp"
#include "servo/devices/current_heat.hpp"
#include "servo/devices/debounced_button.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/jointed_arm.hpp"
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
  [[nodiscard]] const ArmCounts& counts() const noexcept { return counts_; }

  // An arm that it may be.
  struct LookAlike {
    ArmKinematics arm;
    std::array<int, 3> home_counts;
  };

 private:
  struct Interval {  // of two reports [s]
    double time_s, waited_s;
    double silent_s;  // of the time: beyond what a report takes it said nothing
  };
  void take(const Received& received) noexcept;
  void measurePace();
  [[nodiscard]] int delayTicks() const noexcept;
  enum class Pending {  // what the device was told last, and has not answered
    kNothing,
    kForgetting,   // to count from home, uncalibrated
    kCalibrating,  // to count from home
    kCountingOn,   // to count from what it counts, after a refusal
  };
  void tell(Pending what) noexcept;
  void heedButton(const PolhemState& state, bool just_before) noexcept;
  void press() noexcept;
  void noteRest() noexcept;
  void noteImpossible() noexcept;
  [[nodiscard]] double time_s() const noexcept;
  [[nodiscard]] double reportTime_s() const noexcept;
  [[nodiscard]] bool rests() const noexcept;
  [[nodiscard]] bool isFree() const noexcept;
  [[nodiscard]] double way_m(const Vec3& from, const Vec3& to) const noexcept;
  [[nodiscard]] double silence_s() const noexcept;
  [[nodiscard]] bool follows(const PolhemCounts& raw, const Interval& since) noexcept;
  void countFrom(const PolhemCounts& raw) noexcept;
  void countOn(const PolhemCounts& raw) noexcept;
  [[nodiscard]] bool isThere() const noexcept;
  [[nodiscard]] Interval intervalTo(const Received& received) const noexcept;
  [[nodiscard]] double longestWay_m(const Interval& interval) const noexcept;
  [[nodiscard]] bool isHome(const PolhemCounts& raw) const noexcept;
  [[nodiscard]] double sinceWrite_s() noexcept;
  void passHeat() noexcept;
  [[nodiscard]] Vec3 currentsFor(const Vec3& force_D, double& share) const noexcept;
  [[nodiscard]] double forceLimit_N() const noexcept;
  [[nodiscard]] double doubtful_N(const Vec3& currents_A) const noexcept;
  [[nodiscard]] bool isPossible() const noexcept;
  void post(const Vec3& currents_A, double force_N) noexcept;

  [[nodiscard]] Vec3 angles() const noexcept override { return angles_; }
  [[nodiscard]] Vec3 counts_rad() const noexcept override;
  [[nodiscard]] bool canBeTried() const noexcept override;
  [[nodiscard]] Vec3 levers_m() const noexcept override;
  [[nodiscard]] double mass_kg() const noexcept override { return parameters_.mass_kg; }
  [[nodiscard]] double damping_Ns_per_m() const noexcept override { return parameters_.damping_Ns_per_m; }
  void push(int motor, double force_N) noexcept override;

  PolhemParameters parameters_;
  PolhemUse use_;
  ArmKinematics arm_;
  std::vector<LookAlike> look_alikes_;                        // itself first; where its motors are not checked
  std::atomic<std::uint64_t> garbage_{0}, garbage_bytes_{0};  // counted by the link's thread; of the last one
  ReportLink link_;
  std::uint64_t seen_ = 0;
  std::atomic<std::uint64_t> connection_{0};  // of the last report that counted
  std::uint64_t requests_ = 0, request_ = 0;  // that were heard of last; that a calibration waits for
  std::int64_t received_ns_ = 0;              // when the last report that counted came
  std::int64_t asked_ns_ = 0;                 // since when that may have been so
  std::int64_t silent_ns_ = 0;                // how long the link had heard nothing in all until then
  bool was_unasked_ = false;                  // it came of its own accord
  double report_period_s_ = 0;                // measured at the start; 0: by the simulated clock, or nothing came [s]
  int silent_ticks_ = 0;                      // simulated clock: since the last report that counted
  std::int64_t ticks_ = 0;                    // simulated clock: since the start
  bool pressed_ = false;                      // the handle's switch
  PolhemCounts raw_{};
  ArmCounts counts_{};
  Vec3 angles_ = Vec3::Zero(), position_A_ = Vec3::Zero();  // A: the arm's frame (arm_kinematics.hpp)
  MotionLaw motion_;
  int impossible_poses_ = 0;  // in a row
  int leaps_ = 0;             // in a row
  Vec3 leapt_to_A_ = Vec3::Zero();
  DebouncedButton button_;
  bool is_pressed_now_ = false;                                  // it was seen free a moment before it was pressed
  CalibrationRefusal refused_ = CalibrationRefusal::kNone;       // the last one
  double refused_s_ = -std::numeric_limits<double>::infinity();  // when that was [s]
  bool is_refused_ = false;                                      // the device still holds what it asked
  int unheard_reports_ = 0;   // since the device was told, in which the button still asks
  Vec3 rest_ = Vec3::Zero();  // angles near which the handle stays [rad]
  double rests_since_s_ = 0;  // when it came there [s]
  double pushed_s_ = -std::numeric_limits<double>::infinity();  // when it pushed last [s]
  Pending pending_ = Pending::kNothing;
  CurrentHeat heat_;
  Vec3 flowing_A_ = Vec3::Zero();  // since the last write
  std::int64_t written_ns_ = 0;    // when that was; by the simulated clock unused
  int ticks_since_write_ = 0;      // simulated clock
  std::atomic<bool> calibrated_;
  std::atomic<std::uint64_t> implausible_{0}, impossible_{0}, calibrations_{0};
  std::array<std::atomic<std::uint64_t>, kCalibrationRefusals.size()> refusals_{};
};

}  // namespace palpate
