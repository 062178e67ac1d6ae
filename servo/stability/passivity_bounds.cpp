// SPDX-License-Identifier: Apache-2.0
#include "servo/stability/passivity_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

double samplingBound(const PassiveDevice& device, double damping_Ns_per_m) {
  return std::max(0.0, 2 * device.rate_hz * (device.damping_Ns_per_m - std::abs(damping_Ns_per_m)));
}

double quantisationBound(const PassiveDevice& device) {
  if (!(device.resolution_m > 0)) return std::numeric_limits<double>::infinity();
  return 2 * device.coulomb_friction_N / device.resolution_m;
}

double passiveStiffness(const PassiveDevice& device, double damping_Ns_per_m) {
  return std::min(samplingBound(device, damping_Ns_per_m), quantisationBound(device));
}

}  // namespace palpate
