// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/sampled_volume.hpp: an exact surface sampled on any lattice, with noise if wanted, and what
// sampling does to it.
//
// Density is minus the distance [m], flat where it is larger than `flat_m`, as in a scan; the isovalue is 0.
#pragma once

#include "support/analytic_surface.hpp"
#include "support/seeded.hpp"

namespace palpate {

struct Sampling {
  Lattice lattice{};
  Vec3i size = Vec3i::Constant(64);
  double flat_m = 4e-3;
  double noise_m = 0;  // standard deviation of each sample
  unsigned seed = 0;   // of the noise
};

// The density is computed when a window is cut. For cheap formulas, in volumes of which a path sees little.
inline AnalyticVolume sampledOn(const Sampling& s, const AnalyticSurface& surface) {
  AnalyticVolume volume;
  volume.lattice = s.lattice;
  volume.size = s.size;
  volume.density = [=](const Vec3& p_W) {
    const double density = std::clamp(-surface.distance_m(p_W), -s.flat_m, s.flat_m);
    if (s.noise_m == 0) return density;
    const Vec3i at = s.lattice.toIndex(p_W).array().round().cast<int>();
    const std::uint64_t number = at.x() + s.size.x() * (at.y() + s.size.y() * static_cast<std::uint64_t>(at.z()));
    return density + s.noise_m * noiseAt(s.seed, number);
  };
  return volume;
}

// A lattice around a point of the world: `size` samples, with the point at the middle and `phase` voxels off it.
inline Lattice latticeAround(const Vec3& middle_W, const Vec3i& size, const Vec3& spacing_m,
                             const Mat3& R_WL = Mat3::Identity(), const Vec3& phase = Vec3::Zero()) {
  Lattice lattice{Vec3::Zero(), R_WL, spacing_m};
  lattice.origin_W = middle_W - lattice.toWorld(0.5 * (size - Vec3i::Ones()).cast<double>() + phase);
  return lattice;
}

// The errors of a distance field sampled at the spacings h_a, h_b, h_c, with curvatures of at most 1 / R, in metres and
// radians. Second derivatives are at most 1 / R along any axis, third ones 1.155 / R^2, the mixed ones too.
// - Density: trilinear interpolation errs by the sum of h^2 / 8 f'' over the axes. Along three orthogonal axes the
//   second derivatives sum to the two curvatures, so the sum is at most that of the two widest spacings.
// - Component a of the gradient: h_a^2 / 6 f''' of the central difference, and the sum of h^2 / 8 f''' of its
//   interpolation. The angle is at most the length of the error's vector over the gradient's of 1.
struct SampledBound {
  double metres;
  double radians;
};
inline SampledBound sampledBound(double radius_m, const Vec3& spacing_m) {
  const Vec3 squares = spacing_m.cwiseProduct(spacing_m);
  const double third = 1.155 / (radius_m * radius_m);
  const double interpolated = squares.sum() / 8;
  const Vec3 component = (squares / 6 + Vec3::Constant(interpolated)) * third;
  return {(squares.sum() - squares.minCoeff()) / 8 / radius_m, component.norm()};
}

}  // namespace palpate
