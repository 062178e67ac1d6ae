// SPDX-License-Identifier: Apache-2.0
// apps/touch/force_error.hpp: how far the spring's force of a tick is from the true one, in newtons. `palpate touch`
// reports it and `palpate tune` chooses by it. Any thread.
//
// The force of a contact's spring is K d, with d from the HIP to the surface point nearest to it. Without contact it is
// zero. So its error, the length of a vector, is in a tick in which
//   the tool is in contact, and should be:  K |surface point that was found - true surface point|
//   it should be, and is not:               K times the true depth: the whole force
//   it is, and should not be:               K times the depth that was found
// The three agree where one passes into another, as the depth goes to zero. A contact that begins or ends some ticks
// late is therefore no special case: its error is K times the way into the surface meanwhile, and counts as it is. The
// first touch comes before the slide, and does not count where there is one. The point that was found is the VHIP
// before effects move it. Damping, friction and texture therefore do not count, nor does the force limit.
#pragma once

#include <cstdint>
#include <functional>
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
  double depth_m = 0;            // of the HIP below it; 0 or less: there should be no contact [m]
};

// The point of the exact surface nearest to the HIP. Empty where the phantom's distance is only a bound.
[[nodiscard]] std::optional<TruePoint> exactSurfacePoint(const Phantom& phantom, const Vec3& hip_W);

// The error of a tick [N]. Empty where the tool neither is in contact nor should be; where the algorithm shows no
// surface; where the force is not the spring's alone, since the safety gate holds it back or the passivity controller
// adds to it; and where the true point is on the other side of a wall, whose normal is opposite: which side is right
// depends on where the tool came from.
[[nodiscard]] std::optional<double> forceError_N(double stiffness_N_per_m, const TickRecord& record,
                                                 const TruePoint& truth);

// The errors of a run's ticks, where they are known: of those in the slide, or of all if the slide has none.
struct ForceErrors {
  std::vector<double> errors_N;     // in the ticks' order [N]
  std::int64_t felt_ticks = 0;      // of these, those in contact
  std::int64_t possible_ticks = 0;  // of the slide, or of the run, with or without an error
};
// `truthOf`: of a record; empty where the true point is not known. A run of an algorithm that shows no surface has no
// errors.
[[nodiscard]] ForceErrors forceErrors(double stiffness_N_per_m, const std::vector<TickRecord>& records,
                                      const std::vector<PathPhase>& phases,
                                      const std::function<std::optional<TruePoint>(const TickRecord&)>& truthOf);

// Whether a time is in the phase "slide".
[[nodiscard]] bool inSlide(double time_s, const std::vector<PathPhase>& phases);

// The ticks that errors of place and direction are taken over: in contact, with a force of the surface alone, without
// the passivity controller's. If such ticks exist in the slide, only those. They point into `records`.
struct CountedTicks {
  std::vector<const TickRecord*> ticks;
  bool slide_only = false;
};
[[nodiscard]] CountedTicks countedTicks(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases);

}  // namespace palpate
