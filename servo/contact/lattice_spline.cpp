// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/lattice_spline.hpp"

namespace palpate {
namespace {

// Weights of the samples -1, 0, 1 at u, and their slopes.
struct Weights {
  std::array<double, 3> value, slope;
};

Weights weightsAt(double u) noexcept {
  const double low = 0.5 - u, high = 0.5 + u;
  return {{0.5 * low * low, 0.75 - u * u, 0.5 * high * high}, {-low, -2 * u, high}};
}

}  // namespace

LatticeSpline::At LatticeSpline::evaluate(const Lattice& lattice, const Vec3& u,
                                          const Eigen::Array<bool, 3, 1>& within) const noexcept {
  const Weights x = weightsAt(u.x()), y = weightsAt(u.y()), z = weightsAt(u.z());
  double value = 0;
  Vec3 slope_L = Vec3::Zero();
  const double* row = numbers_.data();
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j, row += 3) {
      const double sum = x.value[0] * row[0] + x.value[1] * row[1] + x.value[2] * row[2];
      const double rise = x.slope[0] * row[0] + x.slope[1] * row[1] + x.slope[2] * row[2];
      value += y.value[j] * z.value[k] * sum;
      slope_L += Vec3(y.value[j] * z.value[k] * rise, y.slope[j] * z.value[k] * sum, y.value[j] * z.slope[k] * sum);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (!within[axis]) slope_L[axis] = 0;
  }
  return {value, lattice.gradientToWorld(slope_L.cwiseQuotient(lattice.spacing_m))};
}

}  // namespace palpate
