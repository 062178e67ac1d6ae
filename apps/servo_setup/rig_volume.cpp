// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/rig_volume.hpp"

#include "servo/contact/effects.hpp"

namespace palpate {

std::unique_ptr<Algorithm> makeAlgorithm(const RigSettings& settings, const RigVolume& volume) {
  const AlgorithmParameters& p = settings.parameters;
  return makeAlgorithm(settings.algorithm,
                       {.parameters = p,
                        .effects = makeContactEffects(settings.effects, p.stiffness_N_per_m, p.rate_hz),
                        .haptization = settings.haptization,
                        .scale = volume.scale,
                        .objects = volume.objects,
                        .isosurface = volume.isosurface});
}

}  // namespace palpate
