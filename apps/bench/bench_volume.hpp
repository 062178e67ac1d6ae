// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_volume.hpp: a phantom with its samples in plain memory (apps/sampled). World frame W [m]. One
// thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "apps/sampled/sampled_volume.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {

// Distance from the point to the nearest face of the phantom's volume; negative outside [voxel].
[[nodiscard]] double borderDistance(const Phantom& phantom, const Vec3& p_W);

class BenchVolume : public SampledVolume {
 public:
  explicit BenchVolume(const std::string& name);  // "phantom:..."; throws Error as makePhantom does
  // Other samples of the phantom's surface: a mask of it, or such a mask filtered. Their isosurface is at `isovalue`.
  BenchVolume(std::unique_ptr<Phantom> phantom, Volume samples, double isovalue,
              const GradientOperator& gradient_operator = {});

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Phantom& phantom() const noexcept { return *phantom_; }
  [[nodiscard]] double borderDistance(const Vec3& p_W) const { return palpate::borderDistance(*phantom_, p_W); }

 private:
  BenchVolume(const std::string& name, std::unique_ptr<Phantom> phantom);
  std::string name_;
  std::unique_ptr<Phantom> phantom_;
};

// The phantom's name with noise added to it. The noise's standard deviation [density] is the change of density over
// `noise_voxel` smallest voxels where the density is steepest. 0 leaves the name as it is. Throws Error as makePhantom
// does.
[[nodiscard]] std::string withNoise(const std::string& phantom, double noise_voxel, std::uint64_t seed);

}  // namespace palpate
