// SPDX-License-Identifier: Apache-2.0
// engine/phantoms/phantom_spec.hpp: the parameters of a phantom, as a user gives them:
// "phantom:NAME?size=64&spacing=1mm&noise=0.05&seed=1".
//
// size: one number or IxJxK [voxel]. spacing: one number or three, with m, mm or um: "0.5x0.5x1.2mm". noise: standard
// deviation, as a share of the density contrast [-]. seed: of noise and of random values. thickness (shell only): of
// the wall, in voxels of the largest spacing. head and lung keep their natural extent if only `size` is given.
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

// One row of the registry.
struct PhantomKind {
  std::string name;
  std::string description;
  Vec3i size;               // default [voxel]
  double natural_extent_m;  // the longest edge, whatever the size [m]; 0: none, and the spacing is 1 mm by default
  std::vector<std::string> extra_keys;
  std::function<std::unique_ptr<Phantom>(const PhantomSpec&)> make;
};

[[nodiscard]] const std::vector<PhantomKind>& phantomKinds();

// Throws Error(kBadInput) for an unknown name or key (and lists the known ones), a value that is not a number, a size
// below 1, a spacing that is not positive or has no unit, noise outside [0, 10], and thickness outside (0, 1000].
[[nodiscard]] PhantomSpec parsePhantomSpec(const std::string& text);

}  // namespace palpate
