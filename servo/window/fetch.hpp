// SPDX-License-Identifier: Apache-2.0
// servo/window/fetch.hpp: density and gradient of a window at one point of the world.
//
// Both are trilinear in the window's lattice, from the same eight samples; the gradient is in the world [density/m]. A
// point outside the window may be past several of its faces. If all of these are borders of the volume, the result is
// kBeyondVolume with density -infinity, else kBeyondWindow. An unusable window and a non-finite point give
// kBeyondWindow.
// Thread: any. Cost: making a WindowSampler and one at(). To fetch often, keep the sampler. Errors: none.
#pragma once

#include "servo/window/sample_window.hpp"

namespace palpate {

[[nodiscard]] Fetch fetch(const SampleWindow& window, const Vec3& p_W) noexcept;

}  // namespace palpate
