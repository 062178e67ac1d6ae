// SPDX-License-Identifier: Apache-2.0
// servo/contact/texture.hpp: texture: the VHIP goes up and down along the normal as the tool slides over the surface.
//
// Both kinds move it by a height that depends on the place of the VHIP alone, not on time, and never by more than the
// amplitude A. A HIP less than A deep feels height * depth / A: so contact begins and ends without a step, and the
// depth never becomes negative. Frame W: world [m]. Thread: move() and release() the servo's.
#pragma once

#include <array>

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

// A solid texture that fills the world: the mean of kWaves plane waves of one wavelength, in the directions of a
// regular tetrahedron turned so that none lies along an axis. On a surface each wave shows as one of at least that
// wavelength. Root mean square: A / sqrt(2 kWaves) = 0.354 A. Cost: some 55 ns (four sines).
class ProceduralTexture final : public ContactEffect {
 public:
  static constexpr int kWaves = 4;

  // `wavelength_m` > 0, `amplitude_m` >= 0.
  ProceduralTexture(double amplitude_m, double wavelength_m) noexcept;

  void release() noexcept override {}
  [[nodiscard]] Vec3 move(const ContactState& contact, const Vec3& vhip_W) noexcept override;

  // Height of the texture at a point, within +-amplitude [m].
  [[nodiscard]] double height(const Vec3& p_W) const noexcept;
  // Of wave i: its height is amplitude / kWaves * sin(k.p + phase) [1/m].
  [[nodiscard]] const Vec3& waveVector(int i) const noexcept { return k_W_[static_cast<std::size_t>(i)]; }

 private:
  double amplitude_m_;
  std::array<Vec3, kWaves> k_W_;
};

// The volume's own fine structure: the density at the VHIP less the mean of six neighbours a voxel away in the tangent
// plane, divided by the steepness there, is how far the surface departs from its trend. The neighbours are the
// lattice's axes laid into the plane, a set that turns with the volume and weighs all directions alike. A smooth
// surface of radius R reads h^2 / (3 R) for voxels of side h, 0.017 h at 20 voxels. Where the window or the volume
// ends, or the gradient is zero, there is no texture. Cost: 7 fetches, some 150 ns.
class DensityTexture final : public ContactEffect {
 public:
  // `gain`: of the departure [-]; the product is cut off at +-`amplitude_m`.
  DensityTexture(double amplitude_m, double gain) noexcept : amplitude_m_(amplitude_m), gain_(gain) {}

  void release() noexcept override {}
  [[nodiscard]] Vec3 move(const ContactState& contact, const Vec3& vhip_W) noexcept override;

 private:
  [[nodiscard]] double departure(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W) const noexcept;

  double amplitude_m_;
  double gain_;
  WindowCache window_;
};

}  // namespace palpate
