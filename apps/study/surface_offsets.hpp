// SPDX-License-Identifier: Apache-2.0
// apps/study/surface_offsets.hpp: how far the isosurface of samples lies from the exact surface, at points of the
// latter.
//
// World frame W [m]. Between samples the field is trilinear, as the servo and the picture have it. Any thread. Cost:
// some fifty trilinear samples a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/phantoms/phantom.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

struct ExactSurfacePoint {
  Vec3 p_W, normal_W;  // on the exact surface; outward
};

// Random points of a phantom's surface, at least `border_voxel` from the volume's faces.
[[nodiscard]] std::vector<ExactSurfacePoint> exactSurfacePoints(const Phantom& phantom, std::size_t count,
                                                                double border_voxel, std::uint64_t seed);

struct SurfaceOffsets {
  double mean_m = 0, rms_m = 0;  // along the normal, outward; of the points that were found
  std::size_t lost = 0;          // points with no crossing of the isovalue within four voxels along the normal
};
[[nodiscard]] SurfaceOffsets surfaceOffsets(const reference::DenseField& field, double isovalue,
                                            std::span<const ExactSurfacePoint> points);

}  // namespace palpate
