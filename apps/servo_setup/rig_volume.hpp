// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/rig_volume.hpp: what an algorithm needs of the volume beside the engine's samples, and the algorithm
// that a rig's settings name. Set-up code; any thread.
#pragma once

#include <memory>

#include "apps/servo_setup/rig_settings.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

// It does not change during a run.
struct RigVolume {
  DensityScale scale = {};
  ContactObjects objects = {};
  // A mesh of the first isovalue's (servo/meshes), for an algorithm that needs it.
  std::shared_ptr<const ContactObject> isosurface = nullptr;
};

// Throws Error(kBadInput) as makeAlgorithm() and makeContactEffects() do.
[[nodiscard]] std::unique_ptr<Algorithm> makeAlgorithm(const RigSettings& settings, const RigVolume& volume);

}  // namespace palpate
