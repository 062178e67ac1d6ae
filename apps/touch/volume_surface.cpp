// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/volume_surface.hpp"

namespace palpate {

bool VolumeSurface::sample(const Vec3& p_W, double& density, Vec3& gradient_W) const {
  return volume_.sample(p_W, density, gradient_W);
}

}  // namespace palpate
