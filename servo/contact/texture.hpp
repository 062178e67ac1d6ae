// SPDX-License-Identifier: Apache-2.0
// servo/contact/texture.hpp: texture: the surface goes up and down as the tool slides over it.
//
// Both kinds raise the depth D by a height h, at most the amplitude A. h depends on the surface point p under the tool
// alone, not on time: D' = D + h(p) s(D). The share s = u (2 - u), u = D / 2A, grows to 1 until the tool is 2A deep. So
// contact begins and ends without a step, and D' grows with D and is never negative.
// The stored energy grows by (D'^2 - D^2) / 2. The VHIP moves by minus the slope of that: D' (1 + h s') - D along the
// normal, and -D' s grad h along the surface. So a bump holds the hand back on its way up and pushes it on down the
// other side. Over the whole bump it gives no energy. shape_operator.hpp says what changes where the surface curves,
// felt_surface.hpp where p is.
// Deeper than 2A the share falls again: s = 1 / sqrt(1 + (D - 2A)^2 / w^2). If it did not, a dent would hold the tool
// along the surface by D' times the bend of h: in a deep press many times K, without damping, and a light hand would
// shake in it. w is such that D' s is never more than one over the largest bend, so the bend adds at most K on a plane,
// and on a ball of radius R as often more as it sees smaller (R / (R - D))^2; a tool that is held by its distance to a
// bumpy surface is held no stiffer than that either. The height is felt in full down to some w (0.6 mm for A = 0.1 mm
// at a wavelength of 1 mm); beyond, the push along the surface goes on as it is there.
// Frame W: world [m]. Thread: move() and release() the servo's. Cost: docs/effects.md.
#pragma once

#include <array>

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/felt_field.hpp"

namespace palpate {

// The most by which a texture multiplies the stiffness along the normal: at D = 0 the share s rises by 1 / A, so with h
// = A the depth D' is 2 D, and K D'^2 / 2 bends by 4 K [-].
inline constexpr double kStiffeningTexture = 4;

// The largest amplitude times the root of its bend: A <= kWidestByBend / sqrt(bend of h / A) [-]. Then 1 / bend >= 4A,
// and there is a depth w of 2.2A or more over which the share can fall.
inline constexpr double kWidestByBend = 0.5;

// The steepest that a texture may be: the tangent of 36 degrees [-].
inline constexpr double kSteepestTexture = 0.735;

// A solid texture that fills the world: the mean of kWaves plane waves of one wavelength. Their directions are those of
// a regular tetrahedron, turned so that none lies along an axis. On a surface each wave shows as a wave of at least
// that wavelength. The root mean square is A / sqrt(2 kWaves) = 0.354 A. With k = 2 pi / wavelength h bends by A k^2 /
// 3 at most in any direction, so A is cut to 0.138 wavelengths; the slope is at most A k / sqrt(3), 27 degrees then.
class ProceduralTexture final : public ContactEffect {
 public:
  static constexpr int kWaves = 4;

  // `wavelength_m` > 0, `amplitude_m` >= 0.
  ProceduralTexture(double amplitude_m, double wavelength_m) noexcept;

  void release() noexcept override {}
  void move(const ContactState& contact, ContactPush& push) noexcept override;

  [[nodiscard]] double amplitude() const noexcept { return amplitude_m_; }  // [m]
  // Height of the texture at a point, within +-amplitude [m].
  [[nodiscard]] double height(const Vec3& p_W) const noexcept { return at(p_W).value; }
  // Wave vector k of wave i, whose height is amplitude / kWaves * sin(k.p + phase) [1/m].
  [[nodiscard]] const Vec3& waveVector(int i) const noexcept { return k_W_[static_cast<std::size_t>(i)]; }

 private:
  [[nodiscard]] LatticeSpline::At at(const Vec3& p_W) const noexcept;

  double bend_per_m2_;  // of h / A
  double amplitude_m_;
  std::array<Vec3, kWaves> k_W_;
};

// The volume's own fine structure. The departure of a sample is its density less the mean of its six neighbours,
// divided by the steepness there: how far a surface through the sample lies off its trend. The steepness is the root
// mean square of the gradient magnitudes of the sample and its neighbours. The departures, times the gain and cut off
// at +-A, are the numbers of a smooth field (lattice_spline.hpp).
// In the mean, neighbours are weighted by one over their distance squared, as in a Laplacian. So a smooth surface of
// radius R has the same departure in every direction, on voxels that are not cubes too: h^2 / (3 R), where 3 / h^2 is
// the sum of one over each side squared. That is 0.017 h at a radius of 20 voxels of side h.
// A is at most kWidest of the smallest side. Without a window or without steepness there is no texture.
class DensityTexture final : public ContactEffect {
 public:
  // Largest A, as a share of the smallest side: 0.212. The field rises by at most 2A a voxel along each of three axes,
  // so it is at most 36 degrees steep.
  static constexpr double kWidest = kWidestByBend / 2.3585;  // the root of LatticeSpline::kMostBend

  // `gain`: multiplies the departure [-]; the product is cut off at +-`amplitude_m`.
  DensityTexture(double amplitude_m, double gain, double rate_hz) noexcept
      : amplitude_m_(amplitude_m), gain_(gain), field_(rate_hz) {}

  void release() noexcept override { field_.release(); }
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  double amplitude_m_;
  double gain_;
  FeltField field_;  // of heights [m]
};

}  // namespace palpate
