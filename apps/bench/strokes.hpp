// SPDX-License-Identifier: Apache-2.0
// apps/bench/strokes.hpp: fast straight strokes of a rigid hand into walls: who misses them?
//
// A stroke comes from free space, meets the exact surface at a point and under an angle given by chance, and goes on
// right through, without mercy. It is counted until the HIP is so far past the surface that K * way reaches the
// device's force limit (8 N at 500 N/m: 16 mm), since until then a hand can be held; in a solid body only as far as the
// HIP gets deeper, since past the middle a virtual tool rightly slips around. Missed: no contact in any of these ticks;
// lost: contact was there and went. Ticks come at kBenchRate_hz, at a phase by chance. Windows follow as
// the program's do, without delay.
//
// A wall of about a voxel may have holes in the samples themselves, which no algorithm can feel: along the way that the
// ideal contact point takes over the wall (a shell: the point of its outer face nearest to the HIP) the samples are
// looked at, across the wall in steps of a fiftieth of a voxel, and strokes on whose way no interpolated density is
// above the isovalue somewhere are left out and counted as `over_hole`. Frame W [m]. The same seed gives the same
// strokes.
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
  bool thin_wall = false;          // a shell around the world's origin: what counts is the way past the wall
  std::uint64_t seed = 1;
};

struct StrokeFigures {
  double speed_m_per_s = 0;
  std::int64_t strokes = 0;  // with a wall in the samples
  std::int64_t over_hole = 0;
  std::int64_t missed = 0;
  std::int64_t lost = 0;
};

// For each entrant, a result for each speed.
[[nodiscard]] std::vector<std::vector<StrokeFigures>> strokeFigures(const BenchVolume& volume,
                                                                    const StrokeRequest& request,
                                                                    std::span<Entrant> entrants,
                                                                    const BenchProgress& progress);

}  // namespace palpate
