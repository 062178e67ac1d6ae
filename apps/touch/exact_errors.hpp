// SPDX-License-Identifier: Apache-2.0
// apps/touch/exact_errors.hpp: how far a run was from the exact surface, which phantoms know. After the run, any
// thread.
#pragma once

#include <optional>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/report/touch_run.hpp"
#include "engine/volume/phantom.hpp"

namespace palpate {

// Over the ticks in steady contact: in contact, with a force that is the surface's alone, within the phase "slide"; all
// such ticks for a path without phases and in a run without one in the slide. The distance of the surface point that
// was found from the exact surface in units of the smallest voxel edge, and the angle between the force and the exact
// normal at the surface point nearest to the HIP. Empty where there was no such tick.
[[nodiscard]] std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                                     const std::vector<PathPhase>& phases);

}  // namespace palpate
