// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_setup.hpp: turns a scene into the parameters of servo loop and simulated device. Set-up code.
#pragma once

#include "apps/scene/scene.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

[[nodiscard]] LoopParameters loopParameters(const Scene& scene);
[[nodiscard]] SimulatedDeviceParameters deviceParameters(const Scene& scene);

}  // namespace palpate
