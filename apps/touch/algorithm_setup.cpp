// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/algorithm_setup.hpp"

namespace palpate {

AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue, const DensityScale& scale) {
  AlgorithmSetup setup;
  setup.parameters = {.isovalue = isovalue,
                      .stiffness_N_per_m = scene.stiffness_N_per_m,
                      .damping_Ns_per_m = scene.damping_Ns_per_m,
                      .plane_renewal_ticks = scene.plane_renewal_ticks};
  for (const std::vector<double>& row : scene.haptization_density) {
    setup.haptization.density.push_back({row.at(0), row.at(1), row.at(2)});
  }
  for (const std::vector<double>& row : scene.haptization_gradient) {
    setup.haptization.gradient.push_back({row.at(0), row.at(1)});
  }
  setup.scale = scale;
  return setup;
}

Plan planFor(const Scene& scene) {
  const AlgorithmEntry* algorithm = findAlgorithm(scene.algorithm);
  Scene planned = scene;
  planned.gradient_all = scene.gradient_all || (algorithm != nullptr && algorithm->gradient_everywhere);
  return makePlan(planned);
}

}  // namespace palpate
