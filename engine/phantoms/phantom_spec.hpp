// SPDX-License-Identifier: Apache-2.0
// engine/phantoms/phantom_spec.hpp: what a user may ask of a phantom:
// "phantom:NAME?size=64&spacing=1mm&noise=0.05&seed=1".
//
// size: one number or IxJxK [voxel]. spacing: one number or three with m, mm or um: "0.5x0.5x1.2mm". noise: standard
// deviation as part of the density contrast [-]. seed: of noise and of random values. thickness (shell only): of the
// wall, in voxels of the largest spacing. head and lung keep their natural size when only `size` is given.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

class Phantom;

struct PhantomSpec {
  std::string text;  // as the user wrote it
  std::string name;
  Vec3i size = Vec3i::Constant(64);         // [voxel]
  Vec3 spacing_m = Vec3::Constant(1.0e-3);  // [m]
  double noise = 0;                         // [-]
  std::uint64_t seed = 1;
  double thickness_voxels = 2;  // [voxel]
};

// One line of the registry.
struct PhantomKind {
  std::string name;
  std::string description;
  Vec3i size;               // default [voxel]
  double natural_extent_m;  // 0: the spacing is 1 mm by default; otherwise the longest edge, whatever the size [m]
  std::vector<std::string> extra_keys;
  std::function<std::unique_ptr<Phantom>(const PhantomSpec&)> make;
};

[[nodiscard]] const std::vector<PhantomKind>& phantomKinds();

// Throws Error(kBadInput) for a name or key that is not known (listing those that are), a value that is no number, a
// size below 1, spacing not positive or without unit, noise outside [0, 10], thickness outside (0, 1000].
[[nodiscard]] PhantomSpec parsePhantomSpec(const std::string& text);

}  // namespace palpate
