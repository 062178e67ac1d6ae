// SPDX-License-Identifier: Apache-2.0
// servo/devices/device.hpp: what the servo asks of a haptic device, real or simulated.
//
// Frame W: world, unless a device's header names another; placed_device.hpp puts that into the world. Units [m, N].
// Threads: only the servo thread calls elapse, read, reportAge_ns, write and held, in this order in each tick. They use
// no heap, lock or throw, and no system call but the device's own I/O, which must not wait. The other functions are
// called before the loop starts.
// Errors: read() and write() give false if the device did not answer. The servo then fades the force to zero. A force
// whose write() gave false was not taken: the device still holds the one that it took last.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/vec.hpp"
#include "servo/devices/hand_dynamics.hpp"
#include "servo/devices/hand_motion.hpp"

namespace palpate {

// Why a device exerts no force, whatever it is told; force_off.hpp has the words.
enum class ForceOff : std::uint8_t {
  kNone,            // it does exert forces
  kInputOnly,       // it has no motors
  kNoCurrentLimit,  // nobody said what its amplifiers bear
  kUncalibrated,    // nobody knows where its handle is
  kLimitZero,       // its force limit is 0
  kDisconnected,    // it is not there
  kClutched,        // its handle's switch is pressed
};

// Why a device does not take its handle's place for its home position; calibration_refusal.hpp has the words.
enum class CalibrationRefusal : std::uint8_t {
  kNone,     // it does take it
  kContact,  // it pushes the hand, or did a moment ago
  kMoving,   // the handle moves, or has not been seen at rest yet
  kAway,     // the device is calibrated, and says that the handle is elsewhere
};

// A count or a time that a device tells of itself, for summaries.
struct DeviceFigure {
  std::string_view key;  // "reports_lost", "write_p99_us"
  double value = 0;
};

struct DeviceBoundary {
  Vec3 force_W = Vec3::Zero();  // [N]
  double stored_J = 0;          // the energy of its spring [J]
};

struct DeviceLimits {
  double force_limit_N = 0;            // largest force in any direction [N]
  bool motors_unchecked = false;       // nobody has seen that its motors pull as they should: it exerts less
  double position_resolution_m = 0;    // of its encoders; 0: rounding is negligible [m]
  int force_delay_ticks = 0;           // from write() to the force that acts, in servo ticks
  double slew_limit_N_per_s = 0;       // fastest change of force that it can follow; 0: not stated [N/s]
  bool sets_pace = false;              // that delay follows from its reports, whatever the servo's rate
  bool follows_force = true;           // false: no force moves it, so no contact with it can be unstable
  double stiffness_limit_N_per_m = 0;  // stiffest contact that its maker states; 0: not stated [N/m]
  double workspace_radius_m = 0;       // around its origin; 0: not stated [m]
  bool is_held = false;      // a person holds it, and its motors move that hand: no force of it may begin at once
  MotionBounds motion = {};  // what its handle can do
};

// At the handle, of an arm whose motors nobody has checked [N].
inline constexpr double kUncheckedForce_N = 1;

class JointedArm;

class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual DeviceLimits limits() const noexcept = 0;
  // Device and hand, for what a contact can bear: one if the hand is known, several hands to reckon with if it is not.
  // Empty: nothing is known of them, or no force moves the device. Set-up code; allocates.
  [[nodiscard]] virtual std::vector<HandParameters> hands() const { return {}; }

  // Why it exerts no force now. Any thread. For any reason but kInputOnly the servo fades the force, so that it comes
  // back evenly.
  [[nodiscard]] virtual ForceOff forceOff() const noexcept { return ForceOff::kNone; }
  // What happened so far. Any thread; allocates.
  [[nodiscard]] virtual std::vector<DeviceFigure> figures() const { return {}; }

  // The handle is in its home position: a device that counts from there is told so, unless it has a reason to doubt
  // it. forceOff() says when it is done. Before the loop starts, or by the servo thread.
  [[nodiscard]] virtual CalibrationRefusal calibrate() noexcept { return CalibrationRefusal::kNone; }

  // Null: its motors cannot be tried one at a time. Servo thread.
  [[nodiscard]] virtual JointedArm* arm() noexcept { return nullptr; }

  // Advances simulated time. `ticks`: grid periods since the last tick: 1, or more after missed deadlines. Not called
  // before the first tick. A real device leaves this empty.
  virtual void elapse(int ticks) noexcept { static_cast<void>(ticks); }
  // Where the HIP is now; `position_W` is left alone on failure.
  [[nodiscard]] virtual bool read(Vec3& position_W) noexcept = 0;
  // The age of the position that the last read() gave [ns]. A device that sends reports of its own accord says how long
  // ago the newest one came. A device that answers each read() at once leaves this 0. If the age is not less than the
  // time since the last tick, the servo treats the position as one that it has already used.
  [[nodiscard]] virtual std::int64_t reportAge_ns() const noexcept { return 0; }
  // Why a calibration was refused that somebody asked for in the last seconds, as by a button; kNone: none was. Servo
  // thread, after read().
  [[nodiscard]] virtual CalibrationRefusal refusedCalibration() const noexcept { return CalibrationRefusal::kNone; }
  // Whether its handle's switch is pressed; servo thread, after read().
  [[nodiscard]] virtual bool pressed() const noexcept { return false; }
  // No motion leads to the position that the last read() gave: a run begins there, or goes on there. Servo thread.
  virtual void beginAnew() noexcept {}
  // The last tick of a run is over: what follows only brings the force to zero. Servo thread.
  virtual void endRun() noexcept {}
  // Whether the tool has been put elsewhere since the last call: it did not go there, so whatever lies between is not
  // felt, and everything begins anew. Servo thread, after read().
  [[nodiscard]] virtual bool leapt() noexcept { return false; }
  // The force with which the end of its workspace pushes the handle back, at the position that the last read() gave.
  // The servo adds it to the contact's, in front of the safety gate.
  [[nodiscard]] virtual DeviceBoundary boundary() const noexcept { return {}; }
  // The force to hold until the next write.
  [[nodiscard]] virtual bool write(const Vec3& force_W) noexcept = 0;
  // The force that the device holds after it took a write() of `force_W`: the same, or less if it cuts to a limit of
  // its own. A device that rounds forces must not report the rounded force. Otherwise a ramp with steps smaller than
  // the rounding would never advance.
  [[nodiscard]] virtual Vec3 held(const Vec3& force_W) const noexcept { return force_W; }
};

}  // namespace palpate
