// SPDX-License-Identifier: Apache-2.0
// apps/study/wave_field.hpp: a field whose gradient is known everywhere: a sum of plane waves. It has derivatives of
// all orders and no ramp that is cut off, so an operator shows its order of convergence on it. Any thread.
//
// Frame: world W [m]; the lattice's first voxel is at the origin, its axes along the world's. The shortest wave has
// kShortest_m; the waves differ in length and direction, so that an operator which loses more of one than of another
// turns the gradient. Densities are centred on 0, which is the isovalue.
#pragma once

#include <array>
#include <cstdint>

#include "engine/field/volume.hpp"

namespace palpate {

class WaveField {
 public:
  static constexpr double kShortest_m = 25.1e-3;  // 2 pi / 0.25 per mm
  static constexpr double kEdge_m = 64e-3;        // of the cube that volumes cover

  explicit WaveField(std::uint64_t seed);  // of directions, lengths and phases

  [[nodiscard]] double density(const Vec3& p_W) const;
  [[nodiscard]] Vec3 gradient(const Vec3& p_W) const;  // [density/m]
  [[nodiscard]] double usualGradient_per_m() const;    // its root mean square over space [density/m]

  // The cube as `edge` voxels along each axis, with Gaussian noise of this standard deviation, as a share of that of
  // the field itself.
  [[nodiscard]] Volume volume(int edge, double noise, std::uint64_t seed) const;
  [[nodiscard]] static double spacing_m(int edge) { return kEdge_m / edge; }

 private:
  struct Wave {
    Vec3 k_per_m;  // wave vector
    double phase_rad;
  };
  static constexpr double kAmplitude = 1000;  // of each wave [density]
  std::array<Wave, 6> waves_;
};

}  // namespace palpate
