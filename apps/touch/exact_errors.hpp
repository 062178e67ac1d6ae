// SPDX-License-Identifier: Apache-2.0
// apps/touch/exact_errors.hpp: the errors of a run against the exact surface, which is known for phantoms. After the
// run, any thread.
#pragma once

#include <optional>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/report/touch_run.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {

// The errors are the distance of the surface point that the algorithm found from the exact surface, in units of the
// smallest spacing [voxel], and the angle between the force and the exact normal at the surface point nearest to the
// HIP. They are taken over the ticks in contact with a force of the surface alone, without the passivity controller's.
// If such ticks exist in the phase "slide", only those count. Empty if there are none at all.
[[nodiscard]] std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                                     const std::vector<PathPhase>& phases);

}  // namespace palpate
