// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/contact_bounds.hpp: can this device render this contact, or will it shake? Asked before the servo
// starts.
//
// The answer is that of the linear sampled loop (settlesSoon() in servo/stability/sampled_loop.hpp), for each hand that
// the device reckons with (Device::hands()), with the largest stiffness that the settings and their effects can make. A
// wall that is stable but does not settle soon counts as one that shakes. Encoders that round make it up to 4 / pi
// stiffer. Swings of a few of their steps know no damping, and must die by dry friction (the device's, or 0.02 N) or
// without. It knows no curved surface and no limits of the force. An adaptive velocity estimate counts as its
// shortest window. Set-up code: tens of microseconds for mayShake(), some milliseconds for a bound or a warning,
// whatever the device's delay.
#pragma once

#include <string>
#include <vector>

#include "apps/servo_setup/rig_settings.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

// Whether the contact may swing on in a hand: it does not settle soon in the linear loop, or nothing is known of the
// device, or the algorithm has no stiffness. Asked at every change of the settings.
[[nodiscard]] bool mayShake(const RigSettings& settings, const LoopParameters& loop, const Device& device);

// The largest damping with which some wall settles soon in every hand, in two digits [N s/m]. Infinite: nothing is
// known of the device, or the algorithm has no stiffness.
[[nodiscard]] double renderableDamping(const RigSettings& settings, const LoopParameters& loop, const Device& device);

// The largest stiffness that settles soon in every hand, with the settings' damping and effects [N/m]: what a warning
// names. Infinite: nothing is known of the device, or the algorithm has no stiffness.
[[nodiscard]] double renderableStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device);

// The stiffness to begin with on a device that a person holds, where nobody asked for one [N/m]: what its maker states,
// or else the settings'; in both cases no more than renderableStiffness(), and than its encoders and its dry friction
// make passive (servo/stability/passivity_bounds.hpp), in two digits. A device that no force moves gets the settings'.
[[nodiscard]] double usualStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device);

// The damping to begin with there [N s/m]: the settings', at most the largest with which some wall settles in every
// hand, in two digits.
[[nodiscard]] double usualDamping(const RigSettings& settings, const LoopParameters& loop, const Device& device);

// What lies beyond the bounds, one line each, with the values that would be safe. Empty: nothing does, or nothing is
// known. The passivity controller bears more, but nobody knows how much before a run.
[[nodiscard]] std::vector<std::string> boundWarnings(const RigSettings& settings, const LoopParameters& loop,
                                                     const Device& device);

}  // namespace palpate
