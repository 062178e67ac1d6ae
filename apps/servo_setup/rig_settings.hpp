// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/rig_settings.hpp: what of a rig may be changed while it runs. Any thread; no cost.
#pragma once

#include <string>

#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/safety/safety_gate.hpp"

namespace palpate {

struct RigSettings {
  std::string algorithm = std::string(algorithms().front().name);
  AlgorithmParameters parameters = {};  // the rate is the loop's, the isovalue a float, as the GPU has it
  TransferTables haptization = {};
  EffectParameters effects = {};
  double force_limit_N = SafetyParameters{}.force_limit_N;  // at most the device's own counts [N]

  bool operator==(const RigSettings&) const = default;
};

}  // namespace palpate
