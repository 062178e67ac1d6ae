// SPDX-License-Identifier: Apache-2.0
#include "base/lattice.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/units.hpp"

namespace palpate {

namespace {

std::string inMillimetres(const Vec3& p_m) {
  return formatted("{} x {} x {} mm", p_m.x() * kMillimetresPerMetre, p_m.y() * kMillimetresPerMetre,
                   p_m.z() * kMillimetresPerMetre);
}

}  // namespace

void checkLattice(const Lattice& lattice, const std::string& input) {
  const auto refuse = [&](const std::string& what, const char* remedy) {
    throw Error(Error::Code::kBadInput, input, what, remedy);
  };
  const Vec3& h = lattice.spacing_m;
  if (!h.allFinite() || h.minCoeff() <= 0) {
    refuse(formatted("spacing {} is not positive", inMillimetres(h)),
           "write the true voxel size into the file's header");
  }
  if (h.minCoeff() < kFinest_m || h.maxCoeff() > kCoarsest_m) {
    refuse(formatted("spacing {} is not within {} m to {} m", inMillimetres(h), kFinest_m, kCoarsest_m),
           "write the true voxel size into the file's header");
  }
  if (!lattice.origin_W.allFinite()) refuse("its origin is not finite", "write the true origin into the file's header");
  const double far_m = lattice.origin_W.cwiseAbs().maxCoeff();
  if (far_m > kFarthest_voxel * h.minCoeff()) {
    refuse(formatted("it lies {} m from the world's origin, too far from the origin for voxels of {}", far_m,
                     inMillimetres(h)),
           "move the volume to the world's origin");
  }
  const Mat3 product = lattice.R_WL.transpose() * lattice.R_WL;
  if (!product.isIdentity(1e-4)) {
    refuse("its axes are sheared or its orientation is not a rotation", "resample the volume onto orthogonal axes");
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
