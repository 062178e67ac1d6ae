// SPDX-License-Identifier: Apache-2.0
// servo/window/fetch.hpp: density and gradient of a window at one point of the world.
//
// Trilinear in the window's lattice, both from the same eight samples; the gradient comes out in the world [density/m].
// Beyond a face of the window: kBeyondWindow if any face passed is no border of the volume, else kBeyondVolume with
// density -infinity. An unusable window and a non-finite point give kBeyondWindow. Thread: any. Cost: one WindowSampler
// and one at() of it; to fetch often, keep the sampler. Errors: none.
#pragma once

#include "servo/window/sample_window.hpp"

namespace palpate {

[[nodiscard]] Fetch fetch(const SampleWindow& window, const Vec3& p_W) noexcept;

}  // namespace palpate
