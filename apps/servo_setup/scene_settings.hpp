// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/scene_settings.hpp: turns a scene into the parameters of servo loop, device, contact effects and
// rig. Set-up code.
#pragma once

#include "apps/scene/scene.hpp"
#include "apps/servo_setup/rig_settings.hpp"
#include "servo/contact/effects.hpp"
#include "servo/devices/registry.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

[[nodiscard]] LoopParameters loopParameters(const Scene& scene);

// `path` must outlive the device. A parameter that the scene leaves as the default device has it is not given: another
// device then has its own usual value. What another device does not have is refused if the scene changes it. Throws
// Error(kBadInput) for an unknown device.
[[nodiscard]] DeviceSetup deviceSetup(const Scene& scene, const Path& path);

// Throws Error(kBadInput) for an unknown texture.
[[nodiscard]] EffectParameters effectParameters(const Scene& scene);

// `isovalue`: of the field that is felt [density]. Throws Error(kBadInput) for an unknown texture.
[[nodiscard]] RigSettings rigSettings(const Scene& scene, double isovalue);

// The scene with these settings in place of its own: rigSettings() gives them back. Its rate stays.
[[nodiscard]] Scene withRigSettings(Scene scene, const RigSettings& settings);

// What was changed from `before` to `wanted`, and no more, changed in `present`. Another rate is not taken over.
[[nodiscard]] RigSettings withChanges(const RigSettings& present, const RigSettings& before, const RigSettings& wanted);

// How much damping the scene lacks for a passive wall [N s/m]; 0 if none. A sampled wall needs K T / 2 + K T d (Colgate
// and Schenkel 1997), with the scene's largest stiffness K, the period T of a tick and a force that is d ticks late. 0
// for an algorithm without a stiffness.
[[nodiscard]] double lackingDamping(const Scene& scene, const DeviceLimits& device);

}  // namespace palpate
