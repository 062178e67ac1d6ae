// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/wire_settings.hpp: settings, devices and results as messages between engine and servo, and back, to
// the bit. Any thread; allocates.
//
// What comes back is checked as far as a type needs it (an enumeration, the length of a row); numbers are checked by
// what is made of them.
#pragma once

#include <string>
#include <vector>

#include "apps/servo_setup/rig_settings.hpp"
#include "service/messages/message.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

[[nodiscard]] std::unique_ptr<wire::SettingsT> wireOf(const RigSettings& settings);
// Throws Error(kBadInput) for a row of another length, an unknown texture, and for nothing.
[[nodiscard]] RigSettings settingsOf(const std::unique_ptr<wire::SettingsT>& wire);

[[nodiscard]] std::unique_ptr<wire::VectorT> wireOf(const Vec3& v);
[[nodiscard]] Vec3 vectorOf(const std::unique_ptr<wire::VectorT>& wire);  // zero for nothing

[[nodiscard]] wire::DeviceMadeT wireOf(const Device& device);
[[nodiscard]] DeviceLimits limitsOf(const wire::DeviceMadeT& wire);
[[nodiscard]] std::vector<HandParameters> handsOf(const wire::DeviceMadeT& wire);
// Another number than those that this program knows is kDisconnected.
[[nodiscard]] ForceOff forceOffOf(std::uint8_t wire) noexcept;

}  // namespace palpate
