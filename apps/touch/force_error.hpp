// SPDX-License-Identifier: Apache-2.0
// apps/touch/force_error.hpp: how far the spring's force of a tick is from the true one, in newtons. `palpate touch`
// reports it and `palpate tune` chooses by it. Any thread.
//
// The force of a contact's spring is K d, with d from the HIP to the surface point nearest to it. So an error of that
// point is K times an error of the force:
//     error = K |surface point that was found - true surface point|
// It is the length of the vector, so a wrong depth and a wrong direction both count. The point that was found is the
// VHIP before effects move it. Damping, friction and texture therefore do not count, nor does the force limit.
#pragma once

#include <optional>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/scene/scene.hpp"
#include "engine/phantoms/phantom.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

// K [N/m]: the scene's stiffness, times its largest factor where the stiffness follows the density.
[[nodiscard]] double springStiffness(const Scene& scene);

// The true surface point for one place of the HIP, and the normal there.
struct TruePoint {
  Vec3 point_W = Vec3::Zero();   // [m]
  Vec3 normal_W = Vec3::Zero();  // out of the object [-]
};

// The point of the exact surface nearest to the HIP. Empty where the phantom's distance is only a bound.
[[nodiscard]] std::optional<TruePoint> exactSurfacePoint(const Phantom& phantom, const Vec3& hip_W);

// The error of a tick in contact [N]. Empty where the algorithm shows no surface, and where the true point is on the
// other side of a wall, whose normal is opposite: which side is right depends on where the tool came from.
[[nodiscard]] std::optional<double> forceError_N(double stiffness_N_per_m, const TickRecord& record,
                                                 const TruePoint& truth);

// Whether a time is in the phase "slide".
[[nodiscard]] bool inSlide(double time_s, const std::vector<PathPhase>& phases);

// The ticks that errors are taken over: in contact, with a force of the surface alone, without the passivity
// controller's. If such ticks exist in the slide, only those. They point into `records`.
struct CountedTicks {
  std::vector<const TickRecord*> ticks;
  bool slide_only = false;
};
[[nodiscard]] CountedTicks countedTicks(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases);

}  // namespace palpate
