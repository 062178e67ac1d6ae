// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_setup.hpp: turns a scene into the parameters of servo loop and device. Set-up code.
#pragma once

#include "apps/scene/scene.hpp"
#include "servo/devices/registry.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

[[nodiscard]] LoopParameters loopParameters(const Scene& scene);
// `path` must outlive the device.
[[nodiscard]] DeviceSetup deviceSetup(const Scene& scene, const Path& path);

}  // namespace palpate
