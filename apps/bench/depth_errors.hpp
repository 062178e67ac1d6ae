// SPDX-License-Identifier: Apache-2.0
// apps/bench/depth_errors.hpp: the depth of a picture against a phantom's exact surface. Any thread.
#pragma once

#include "base/camera.hpp"
#include "base/quantile.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {

struct DepthErrors {
  Percentiles voxel;  // of | depth - exact distance along the ray | where both meet the surface [voxel]
  std::size_t holes =
      0;  // pixels that show nothing, though the exact ray goes deeper than half a voxel into the object
  std::size_t false_hits = 0;  // pixels that show something, though the exact ray stays farther out than that
};

// The exact ray is followed in steps of the signed distance, to 1e-4 voxel. Every `stride`-th pixel along x and y.
[[nodiscard]] DepthErrors depthErrors(const RenderedImage& image, const Camera& camera, const Phantom& phantom,
                                      int stride);

}  // namespace palpate
