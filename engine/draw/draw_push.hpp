// SPDX-License-Identifier: Apache-2.0
// engine/draw/draw_push.hpp: camera and style as the kernel draw.comp takes them. Any thread; no cost.
#pragma once

#include "base/camera.hpp"
#include "base/lattice.hpp"
#include "engine/draw/draw_style.hpp"
#include "shaders/draw.layout.h"

namespace palpate {

[[nodiscard]] layout::PictureRays pictureRays(const Lattice& lattice, const Camera& camera);

// All but the tiles and the grid of pixels. Throws Error(kBadInput) for a picture without pixels or of more than can be
// drawn (shaders/picture.layout.h), a camera that is not finite, or one too far away for floats.
[[nodiscard]] layout::DrawPush drawPush(const layout::PoolDomain& domain, const Lattice& lattice, const Camera& camera,
                                        double isovalue);

[[nodiscard]] layout::DrawExtras drawExtras(const Lattice& lattice, const DrawStyle& style);

}  // namespace palpate
