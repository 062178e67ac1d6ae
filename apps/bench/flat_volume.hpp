// SPDX-License-Identifier: Apache-2.0
// apps/bench/flat_volume.hpp: what the edit bench edits: the same surface in volumes of any size. Any thread.
#pragma once

#include "engine/field/volume.hpp"

namespace palpate::flat_volume {

inline constexpr double kIsovalue = 0.5;
inline constexpr double kSpacing_m = 1e-3;
inline constexpr double kPlane_voxel = 3.5;  // above the middle: in the middle of a layer of bricks

// A cube of 1 mm voxels, density 1 below the plane z = size / 2 + 3.5 voxels, 0 above, a ramp of four voxels between
// them. It lies in one layer of bricks; all others are constant.
[[nodiscard]] Volume make(int size);

// One brick of it: 512 values, or the first alone where it returns true.
bool brick(int size, const Vec3i& brick, float* values);

}  // namespace palpate::flat_volume
