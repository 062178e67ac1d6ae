// SPDX-License-Identifier: Apache-2.0
#include "apps/check/distance_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/reference/nearest_across.hpp"
#include "shaders/filter_distance.layout.h"

namespace palpate {
namespace {

struct Bounds {
  double lowest_m = 0, highest_m = 0;  // without the sign of the side
};

// `square`: squared distance to the nearest voxel on the other side [m^2]. If there is none within the band and a
// diagonal, the surface is farther away than the band.
Bounds boundsOf(const std::optional<float>& square, double diagonal_m, double band_m) {
  if (!square) return {band_m, band_m};
  const double across_m = std::sqrt(static_cast<double>(*square));
  return {std::clamp(across_m - diagonal_m, 0.0, band_m), std::min(across_m, band_m)};
}

}  // namespace

void compareWithNearestAcross(Check& check, const reference::DenseField& distance,
                              const reference::DenseField& densities, std::span<const FilterStep> steps,
                              const std::function<void(double)>& progress) {
  const Vec3 spacing_m = densities.lattice.spacing_m;
  const double diagonal_m = spacing_m.norm();
  const double band_m = distanceBand(steps[0]);
  double done = 0;
  const auto tell = [&] { progress(++done / (2.0 * densities.size.z())); };
  reference::AcrossSearch search{steps[0].taps[DISTANCE_ISOVALUE], spacing_m.cwiseAbs2(), Vec3i::Zero(), tell};
  for (int axis = 0; axis < 3; ++axis)
    search.reach[axis] = static_cast<int>(std::ceil((band_m + diagonal_m) / spacing_m[axis]));
  const auto squares = squaresAcross(densities, search);
  // Roundings, in u = 2^-24: the kernel's squared edges (3 u), products and sums (3 u), of which the root has half, and
  // the root's own (1 u): 4 u. Less the diagonal (2 u of it, 1 u of the difference), times the unit (2 u). Here the
  // edges, products and sums 4 u, of which the root has half. Together fewer than 12 u of both lengths.
  const auto rounding_m = [&](double across_m) { return 12 * 0x1p-24 * (across_m + diagonal_m); };
  for (int k = 0; k < densities.size.z(); ++k) {
    for (int j = 0; j < densities.size.y(); ++j) {
      for (int i = 0; i < densities.size.x(); ++i) {
        const Bounds bounds = boundsOf(squares[densities.offset(i, j, k)], diagonal_m, band_m);
        const bool inside = densities.at(i, j, k) > search.isovalue;
        const float got = distance.at(i, j, k);
        const double nearest = inside ? std::clamp<double>(got, bounds.lowest_m, bounds.highest_m)
                                      : std::clamp<double>(got, -bounds.highest_m, -bounds.lowest_m);
        check.compareWithin({i, j, k}, "distance", got, static_cast<float>(nearest), rounding_m(bounds.highest_m));
      }
    }
    tell();
  }
}

}  // namespace palpate
