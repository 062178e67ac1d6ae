// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/algorithm_setup.hpp"

namespace palpate {

AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue, const ContactObjects& objects) {
  AlgorithmSetup setup;
  setup.parameters = {.isovalue = isovalue,
                      .stiffness_N_per_m = scene.stiffness_N_per_m,
                      .damping_Ns_per_m = scene.damping_Ns_per_m,
                      .plane_renewal_ticks = scene.plane_renewal_ticks};
  setup.objects = objects;
  return setup;
}

}  // namespace palpate
