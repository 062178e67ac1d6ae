// SPDX-License-Identifier: Apache-2.0
// apps/bench/strokes.hpp: fast straight strokes of a rigid hand into walls, and which algorithms miss them.
//
// A stroke comes from free space, meets the exact surface at a random point and angle, and goes straight on through the
// wall. Ticks come at kBenchRate_hz, with a random phase. Windows follow as in the program, but without delay.
//
// The ticks that count are those behind the surface in which a hand can be held: while K times the way past the surface
// is below the device's force limit (8 N at 500 N/m: 16 mm). In a solid body they end where the HIP is deepest, since
// past the middle a virtual tool rightly slips around. Missed: no contact in any of these ticks. Lost: contact began
// and ended.
//
// A wall of about a voxel may have holes in the samples themselves, which no algorithm can feel. So the samples are
// checked along the way of the ideal contact point (in a shell: the point of the outer face nearest to the HIP), across
// the wall in steps of a fiftieth of a voxel. If no density is above the isovalue somewhere on this way, the stroke is
// left out and counted in `over_hole`. World frame W [m]. The same seed gives the same strokes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/bench/entrants.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

struct StrokeRequest {
  std::vector<double> speeds_m_per_s = {0.05, 0.1, 0.2, 0.5, 1, 2};
  int strokes = 100;               // for each speed
  double most_incidence_deg = 45;  // between the stroke and the surface's normal
  bool thin_wall = false;          // the wall is a shell around the world's origin; strokes go on past it
  std::uint64_t seed = 1;
};

struct StrokeFigures {
  double speed_m_per_s = 0;
  std::int64_t strokes = 0;    // into a wall without a hole
  std::int64_t over_hole = 0;  // left out
  std::int64_t missed = 0;
  std::int64_t lost = 0;
};

// For each entrant, a result for each speed.
[[nodiscard]] std::vector<std::vector<StrokeFigures>> strokeFigures(const BenchVolume& volume,
                                                                    const StrokeRequest& request,
                                                                    std::span<Entrant> entrants,
                                                                    const BenchProgress& progress);

}  // namespace palpate
