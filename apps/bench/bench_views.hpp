// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_views.hpp: where the pictures of benches and studies are taken from. Any thread; no cost.
#pragma once

#include "apps/bench/random.hpp"
#include "base/camera.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// From a random side, and so far away that the whole volume is seen.
[[nodiscard]] inline Camera randomView(const Volume& volume, Random& random, int width, int height) {
  const Vec3 extent = volume.size().cast<double>().cwiseProduct(volume.lattice().spacing_m);
  const Vec3 middle_W = volume.lattice().toWorld((volume.size().cast<double>().array() - 1) / 2);
  const double x = random.uniform() - 0.5, y = random.uniform() - 0.5, z = 0.7 * random.uniform() - 0.35;
  return lookAt(middle_W, Vec3(x, y, z).normalized(), 2 * extent.maxCoeff(), Vec3::UnitZ(), width, height, 0.5);
}

// The camera as a field sees it whose axes are those of the world (mirrored, where they are left-handed).
[[nodiscard]] inline Camera inFieldFrame(Camera camera, const Lattice& lattice) {
  const auto turned = [&](const Vec3& v_W) -> Vec3 { return lattice.R_WL.transpose() * v_W; };
  camera.position_W = turned(camera.position_W - lattice.toWorld(Vec3::Zero()));
  camera.forward_W = turned(camera.forward_W);
  camera.right_W = turned(camera.right_W);
  camera.up_W = turned(camera.up_W);
  return camera;
}

}  // namespace palpate
