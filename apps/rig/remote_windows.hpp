// SPDX-License-Identifier: Apache-2.0
// apps/rig/remote_windows.hpp: brings an engine's windows to a servo in a process of its own.
#pragma once

#include "apps/servo_side/remote_servo.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

// From now on the engine publishes where this servo's process reads. While nobody reads its exchange. The servo
// outlives that use. Throws as Engine::shareWindows().
void publishTo(RemoteServo& servo, Engine& engine);

}  // namespace palpate
