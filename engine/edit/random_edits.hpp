// SPDX-License-Identifier: Apache-2.0
// engine/edit/random_edits.hpp: random edit commands from a seed, for checks and tests. They are of every kind and of
// many sizes, and lie inside the volume, across its border and just outside. Any thread.
#pragma once

#include <random>

#include "engine/edit/edit_command.hpp"

namespace palpate {

class RandomEdits {
 public:
  RandomEdits(const Vec3i& size, const Lattice& lattice, double low, double high, unsigned seed)
      : size_(size), lattice_(lattice), low_(low), high_(high), random_(seed) {}

  EditCommand next() {
    EditCommand command;
    command.kind = static_cast<EditKind>(random_() % kEditKinds);
    command.from_W = place();
    command.to_W = random_() % 2 == 0 ? command.from_W : place();
    const double h = lattice_.smallestSpacing();
    command.radius_m = h * between(0.3, random_() % 4 == 0 ? 12 : 5);
    command.strength = random_() % 3 == 0 ? 1.0 : between(0.05, 1);
    command.falloff = random_() % 2 == 0 ? 0.0 : between(0, 1);
    command.value = random_() % 4 == 0 ? low_ : between(low_, high_);
    command.plane_W = place();
    command.normal_W = {between(-1, 1), between(-1, 1), between(-1, 1)};
    if (random_() % 3 == 0) command.material = MaterialRate{low_, high_, between(0, 1)};
    // A cut through the middle would clear half of the volume, so cuts take a few voxels at one end of the first axis.
    if (command.kind == EditKind::kCut) {
      command.normal_W = Vec3::UnitX() * (random_() % 2 == 0 ? 1 : -1) + 0.1 * command.normal_W;
      const double i = command.normal_W.x() > 0 ? size_.x() - between(0, 6) : between(-1, 5);
      command.plane_W = lattice_.toWorld({i, size_.y() / 2.0, size_.z() / 2.0});
    }
    if (isStamp(command.kind)) {
      command.stamp = ball(h * between(1, 5));
      command.R_WS = Eigen::Quaterniond(between(-1, 1), between(-1, 1), between(-1, 1), 0.3).normalized().matrix();
    }
    return command;
  }

  // A stamp: the signed distance from a ball of this radius, on a lattice that differs from the volume's.
  static std::shared_ptr<const Stamp> ball(double radius_m) {
    auto stamp = std::make_shared<Stamp>();
    stamp->size = {11, 9, 10};
    stamp->lattice.spacing_m = Vec3(0.30, 0.36, 0.33) * radius_m;
    stamp->lattice.origin_W =
        -0.5 * (stamp->size - Vec3i::Ones()).cast<double>().cwiseProduct(stamp->lattice.spacing_m);
    for (int k = 0; k < stamp->size.z(); ++k) {
      for (int j = 0; j < stamp->size.y(); ++j) {
        for (int i = 0; i < stamp->size.x(); ++i)
          stamp->distance_m.push_back(static_cast<float>(stamp->lattice.toWorld(Vec3(i, j, k)).norm() - radius_m));
      }
    }
    return stamp;
  }

  unsigned pick(unsigned count) { return static_cast<unsigned>(random_() % count); }
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  Vec3 place() {
    Vec3 p_L;
    for (int axis = 0; axis < 3; ++axis) p_L[axis] = between(-4, size_[axis] + 3.0);
    return lattice_.toWorld(p_L);
  }

 private:
  Vec3i size_;
  Lattice lattice_;
  double low_, high_;
  std::mt19937 random_;
};

}  // namespace palpate
