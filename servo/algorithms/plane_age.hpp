// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/plane_age.hpp: how far a plane may be off while it is kept. Each algorithm with a plane says it of
// its own planes (AlgorithmEntry::plane_age_error); warnings, studies and targets ask there.
//
// The tool moves along the surface while the plane stays. After a way w along a level set of curvature k the plane
// lies k w^2 / 2 off. Units: SI. Any thread; no cost, no errors.
#pragma once

namespace palpate {

struct PlaneAge {
  double speed_m_per_s = 0;    // of the tool along the surface
  double rate_hz = 1000;       // 1 / T
  int n = 1;                   // AlgorithmParameters::plane_renewal_ticks
  double curvature_per_m = 0;  // along the way: for the depth that of the level set under the tool, 1 / (R - D); for
                               // the VHIP that of the surface, 1 / R
  double depth_m = 0;          // D
  double voxel_m = 0;          // shortest side

  // The sag of the surface over a way along it [m].
  [[nodiscard]] constexpr double sag(double way_m) const noexcept { return way_m * way_m * curvature_per_m / 2; }
  // The way in so many ticks [m].
  [[nodiscard]] constexpr double way(double ticks) const noexcept { return speed_m_per_s * ticks / rate_hz; }
};

}  // namespace palpate
