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
// smallest spacing [voxel]; the angle between the force and the exact normal at the surface point nearest to the HIP;
// and the error of the spring's force for a stiffness in N/m. The first two are taken over countedTicks(), the last
// over forceErrors(): also ticks in which the tool is not in contact, but should be (force_error.hpp has both). Empty
// if there are no ticks of countedTicks().
[[nodiscard]] std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                                     const std::vector<PathPhase>& phases, double stiffness_N_per_m);

}  // namespace palpate
