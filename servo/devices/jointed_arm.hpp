// SPDX-License-Identifier: Apache-2.0
// servo/devices/jointed_arm.hpp: an arm whose motors can be tried one at a time, each against its own joint.
//
// The arm answers as its kind's table says; motor_check.hpp finds out whether that is so. Threads as in device.hpp: the
// servo thread, after read(). Units: m, rad, N, s. No heap, no errors.
#pragma once

#include "base/vec.hpp"

namespace palpate {

class JointedArm {
 public:
  virtual ~JointedArm() = default;
  [[nodiscard]] virtual Vec3 angles() const noexcept = 0;      // of joints a to c, as the newest report tells
  [[nodiscard]] virtual Vec3 counts_rad() const noexcept = 0;  // what a count of each encoder is [rad]
  // The handle is in the middle of the workspace: there each motor pushes it another way, and none with a force that
  // depends much on where exactly it is.
  [[nodiscard]] virtual bool canBeTried() const noexcept = 0;
  // How far a force of one motor moves the handle while its joint turns by a radian [m].
  [[nodiscard]] virtual Vec3 levers_m() const noexcept = 0;
  // Of an arm that nobody holds: m x'' = F - b x' at the handle.
  [[nodiscard]] virtual double mass_kg() const noexcept = 0;
  [[nodiscard]] virtual double damping_Ns_per_m() const noexcept = 0;
  // In place of write(): the motor alone pushes the handle with `force_N`, so that its joint's angle grows, or shrinks
  // if it is below 0. No force if the device exerts none (Device::forceOff()). At most kMostTrial_N, and less where the
  // device may not give as much. Gives what it pushes with [N].
  static constexpr double kMostTrial_N = 0.6;
  virtual double push(int motor, double force_N) noexcept = 0;
};

}  // namespace palpate
