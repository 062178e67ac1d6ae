// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_host.hpp: the other side of a RemoteServo: makes device, algorithm and loop as an engine's
// process says, and runs them. Links neither Vulkan nor OpenVDB.
//
// The servo's thread does what it does in one process (servo/loop); this thread talks with the engine. If the engine's
// process is gone, the force goes to zero and the run ends.
#pragma once

#include "service/channel/channel.hpp"

namespace palpate {

// Until the run that the engine asks for has ended. Throws Error(kDevice) if the engine is gone before, and what its
// messages make impossible, which the engine is told too.
void runServoHost(Channel channel);

}  // namespace palpate
