// SPDX-License-Identifier: Apache-2.0
// apps/palpate/check_motors.hpp: palpate calibrate --check: do the motors of an arm pull the right way, and is it the
// arm that it was said to be?
#pragma once

#include <string>
#include <vector>

#include "servo/devices/device.hpp"

namespace palpate {

// Each motor pushes a handle that is held loosely in the middle of the workspace; then a hand moves it right, up, and
// towards its user. Says on the terminal what is to be done. Blocks for some 15 s, and for a minute where nobody does
// what it asks. `look_alikes`: names of kinds that it may be instead. Throws Error: kDevice with each motor that is not
// right, or what the hand found, and what to do; kCancelled on Ctrl-C.
void checkMotors(Device& device, const std::string& kind, const std::vector<std::string>& look_alikes);

}  // namespace palpate
