// SPDX-License-Identifier: Apache-2.0
// apps/held/held_words.hpp: what a user of a real device must know when the servo begins. Set-up code; any thread.
#pragma once

#include <string>
#include <vector>

#include "servo/devices/device.hpp"
#include "servo/devices/placed_device.hpp"

namespace palpate {

// Of a device of this kind whose motors nobody has checked: why its forces stay small, and what to do about it.
struct UncheckedWords {
  std::string reason, remedy;
};
[[nodiscard]] UncheckedWords uncheckedWords(const std::string& kind);

// How the device of this name lies in the scene, why it exerts no force, if it does not, and what its maker advises
// against.
[[nodiscard]] std::vector<std::string> heldDeviceWords(const std::string& name, const Device& device,
                                                       const Placement& placement, double stiffness_N_per_m);

}  // namespace palpate
