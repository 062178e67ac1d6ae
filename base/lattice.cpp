// SPDX-License-Identifier: Apache-2.0
#include "base/lattice.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/units.hpp"

namespace palpate {

void checkLattice(const Lattice& lattice, const std::string& input) {
  const Vec3& h = lattice.spacing_m;
  if (!h.allFinite() || h.minCoeff() <= 0) {
    throw Error(Error::Code::kBadInput, input,
                formatted("spacing {} x {} x {} mm is not positive", h.x() * kMillimetresPerMetre,
                          h.y() * kMillimetresPerMetre, h.z() * kMillimetresPerMetre),
                "write the true voxel size into the file's header");
  }
  const Mat3 product = lattice.R_WL.transpose() * lattice.R_WL;
  if (!lattice.origin_W.allFinite() || !product.isIdentity(1e-4)) {
    throw Error(Error::Code::kBadInput, input, "its axes are sheared or its orientation is not a rotation",
                "resample the volume onto orthogonal axes");
  }
}

WorldBox worldBoxOf(const Lattice& lattice, const Vec3i& size) {
  const Vec3 last_L = (size - Vec3i::Ones()).cast<double>();
  WorldBox box{lattice.origin_W, lattice.origin_W};
  for (int corner = 1; corner < 8; ++corner) {
    const Vec3 p_W = lattice.toWorld(Vec3(corner & 1, corner >> 1 & 1, corner >> 2).cwiseProduct(last_L));
    box.low_W = box.low_W.cwiseMin(p_W);
    box.high_W = box.high_W.cwiseMax(p_W);
  }
  return box;
}

}  // namespace palpate
