// SPDX-License-Identifier: Apache-2.0
// engine/phantoms/phantom.hpp: volumes whose surface is known exactly, so that every pass and algorithm can be compared
// with it.
//
// Frame: world [m]. The lattice's centre, and with it the object's, is the world's origin; axes i, j, k run along +x,
// +y, +z. Signed distance: NEGATIVE INSIDE the object, positive outside. Near the surface the density is linear in it:
//     density = isovalue - slope * signed distance,   clamped to the values far inside and far outside,
// so the only error of central differences comes from the surface's curvature. Values are CT-like (air -1000).
// Thread: const after construction; any thread. Cost of a distance: 10 ns (sphere) to about 5 us (gyroid).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/field/volume.hpp"
#include "engine/phantoms/phantom_spec.hpp"

namespace palpate {

// Where a point lies relative to a surface.
struct SurfaceOffset {
  double distance_m = 0;        // signed, negative inside [m]
  Vec3 normal = Vec3::UnitZ();  // outward unit normal at the nearest surface point: the distance's gradient [-]
};

class Phantom {
 public:
  struct Profile {
    double isovalue = 0;     // [density]
    double low = -1000;      // far outside [density]
    double high = 1000;      // far inside [density]
    double slope_per_m = 0;  // of the ramp between them [density/m]
  };

  virtual ~Phantom() = default;
  Phantom(const Phantom&) = delete;
  Phantom& operator=(const Phantom&) = delete;

  // The exact surface. For a phantom of several bodies the distance may be only a bound in places; its .cpp says where.
  // The zero set is exact and the distance 1-Lipschitz everywhere. NaN if hasSurface() is false.
  [[nodiscard]] virtual SurfaceOffset offset(const Vec3& p_W) const = 0;
  [[nodiscard]] double signedDistance_m(const Vec3& p_W) const { return offset(p_W).distance_m; }
  [[nodiscard]] Vec3 normal(const Vec3& p_W) const { return offset(p_W).normal; }
  [[nodiscard]] virtual bool hasSurface() const { return true; }

  // The density before noise. By default the profile's ramp.
  [[nodiscard]] virtual double density(const Vec3& p_W) const;

  // Every voxel before noise, i fastest. Cost: follows the surface, not the volume.
  [[nodiscard]] virtual std::vector<float> densities() const;

  // Whether every voxel before noise is density() at its centre, so that the volume can be made brick by brick.
  [[nodiscard]] virtual bool isByPlace() const { return true; }
  // For such a phantom: brick() is as Volume::readBrick. isConstantBrick() is true only for constant bricks, but not
  // for all of them; it costs one distance.
  bool brick(const Vec3i& brick, float* values) const;
  [[nodiscard]] bool isConstantBrick(const Vec3i& brick) const;

  [[nodiscard]] double isovalue() const noexcept { return profile_.isovalue; }  // density of the exact surface
  [[nodiscard]] const Profile& profile() const noexcept { return profile_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] const Vec3i& size() const noexcept { return spec_.size; }
  [[nodiscard]] const PhantomSpec& spec() const noexcept { return spec_; }

 protected:
  Phantom(const PhantomSpec& spec, const Profile& profile);

  // A radius around p_W within which the density is certainly constant [m]; 0 if none is known. By default from the
  // profile; a class that overrides density() overrides this too.
  [[nodiscard]] virtual double constantRadius_m(const Vec3& p_W) const;

  // The same for a 1-Lipschitz distance. The ramp reaches from `below_m` inside its zero set to `above_m` outside.
  [[nodiscard]] static double beyondRamp_m(double distance_m, double below_m, double above_m);

 private:
  [[nodiscard]] Vec3 middleOf(const Vec3i& first, int edge_voxels) const;  // of a block of voxels [m]
  [[nodiscard]] bool isConstantAround(const Vec3& middle_W, int edge_voxels) const;

  PhantomSpec spec_;
  Profile profile_;
  Lattice lattice_;
};

// Makes the phantom of a name "phantom:NAME?key=value&...". Throws Error(kBadInput) as parsePhantomSpec does.
[[nodiscard]] std::unique_ptr<Phantom> makePhantom(const std::string& text);

// The phantom's volume: its densities plus Gaussian noise with the standard deviation spec.noise * (high - low). The
// noise is a sum of twelve uniforms, so its tails end at 6 sigma. The same seed gives the same bits on every machine.
// Memory: the bricks that are not constant, so without noise a phantom may be as large as any volume. With noise, and
// for `random`, 4 bytes a voxel besides.
[[nodiscard]] Volume makeVolume(const Phantom& phantom);

// makePhantom() and makeVolume() in one, for loadVolume. Throws Error also if the volume would need more memory than
// the budget (0: than the machine has free).
[[nodiscard]] Volume phantomVolume(const std::string& name, std::size_t memory_budget_bytes);

}  // namespace palpate
