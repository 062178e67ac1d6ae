// SPDX-License-Identifier: Apache-2.0
// apps/study/mask_shapes.hpp: masks of bodies whose surface is known exactly: 1 in the object, 0 outside, as the
// segmentation of a scan has them.
//
// The body is a phantom's, turned and moved by a part of a voxel, so that no face of it lies along the lattice. World
// frame W [m]. Any thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/phantoms/phantom.hpp"

namespace palpate {

inline constexpr double kMaskIsovalue = 0.5;  // half-way between the two values

struct MaskShape {
  std::string name;                         // in words: "ball of 20 voxels"
  std::string body;                         // the phantom whose surface it has, on cubes of 1 mm
  Vec3i size = Vec3i::Zero();               // of the mask [voxel]
  Vec3 spacing_m = Vec3::Constant(1.0e-3);  // of the mask [m]
  double depth_mm = 2;                      // how deep a tool may press and stay in it
};

// Balls of 6 to 40 voxels, a box with sharp edges, a tube, a thin wall; a ball and a box on slices three times as thick
// as their pixels are wide.
[[nodiscard]] const std::vector<MaskShape>& maskShapes();

// Its densities are the mask's, its offsets those of the exact surface. `seed`: of turn and place.
[[nodiscard]] std::unique_ptr<Phantom> makeMask(const MaskShape& shape, std::uint64_t seed);

}  // namespace palpate
