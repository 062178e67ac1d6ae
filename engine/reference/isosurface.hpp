// SPDX-License-Identifier: Apache-2.0
// engine/reference/isosurface.hpp: the CPU twin of the depth of shaders/draw.comp: where a ray meets the
// isosurface. It goes in small steps and skips nothing: slow and obvious. Any thread.
#pragma once

#include <functional>
#include <optional>

#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Trilinear density at a point of the lattice frame L [voxel], clamped to the domain; computed in double.
[[nodiscard]] double trilinear(const DenseField& field, const Vec3& p_L);

// Distance [m] from `eye_W` along the unit direction to the first point with density above the isovalue, inside the
// domain and where `kept` says so (of a point in the world; all, if it is empty). Steps of `step_voxels` find it,
// bisection refines it. Empty if there is none.
[[nodiscard]] std::optional<double> firstHit(const DenseField& field, double isovalue, const Vec3& eye_W,
                                             const Vec3& direction_W, double step_voxels,
                                             const std::function<bool(const Vec3& p_W)>& kept = {});

}  // namespace palpate::reference
