// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/entrants.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "servo/contact/effects.hpp"
#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

ContactEffects makeRecovery() {
  EffectParameters parameters;
  parameters.recovery_s = kRecoveryTime_s;
  return makeContactEffects(parameters, kBenchStiffness_N_per_m, kBenchRate_hz);
}

AlgorithmSetup setupFor(const BenchVolume& volume, const AlgorithmNeeds& needs, int n, ContactEffects effects) {
  return {.parameters = {.isovalue = volume.isovalue(),
                         .stiffness_N_per_m = kBenchStiffness_N_per_m,
                         .damping_Ns_per_m = 0,
                         .plane_renewal_ticks = n},
          .effects = std::move(effects),
          .haptization = {},
          .scale = volume.scale(),
          .isosurface =
              needs.isosurface_mesh ? std::make_shared<const MeshObject>(volume.isosurface(), "isosurface") : nullptr};
}

}  // namespace

Entrant makeEntrant(const BenchVolume& volume, const std::string& algorithm, int n, const std::string& effects) {
  const AlgorithmEntry& entry = algorithmEntry(algorithm);
  ContactEffects made = effects == kRecoveryChoice ? makeRecovery() : ContactEffects{};
  return {algorithm, n, effects, makeAlgorithm(algorithm, setupFor(volume, entry.needs, n, std::move(made))),
          entry.traits};
}

Entrants makeEntrants(const BenchVolume& volume, const std::vector<int>& renewals,
                      const std::vector<std::string>& effects) {
  Entrants entrants;
  for (const AlgorithmEntry& entry : algorithms()) {
    const std::string name(entry.name);
    try {
      for (const int n : renewals) {
        for (const std::string& choice : effects) {
          entrants.list.push_back(makeEntrant(volume, name, n, choice));
        }
      }
    } catch (const Error& error) {
      std::erase_if(entrants.list, [&](const Entrant& entrant) { return entrant.algorithm == name; });
      entrants.left_out.push_back(name + ": " + error.what());
    }
  }
  return entrants;
}

}  // namespace palpate
