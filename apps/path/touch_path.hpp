// SPDX-License-Identifier: Apache-2.0
// apps/path/touch_path.hpp: builds the tool's path from the surface itself: approach, press, slide, retreat.
//
// World frame [m], seconds. Set-up code, any thread. The same field and request give the same path, bit for bit.
// Cost: the pieces of the object (object_pieces.hpp), the search for a start (start_search.hpp), then about 40 samples
// for each quarter of a voxel slid.
#pragma once

#include <string>
#include <vector>

#include "apps/path/path_request.hpp"
#include "apps/path/surface_search.hpp"
#include "apps/path/timed_point.hpp"

namespace palpate {

inline constexpr double kPathInterval_s = 2.0e-3;  // between points; coarser only for paths above 1e6 points

struct TouchPath {
  std::vector<TimedPoint> points;  // evenly spaced in time, from 0 to the duration exactly; for cubic interpolation
  std::vector<PathPhase> phases;   // approach, press, slide, retreat, without gaps
  SurfaceHit start;                // where the press begins
  Vec3 slide_W = Vec3::Zero();     // unit direction in which the slide begins; zero without a slide [-]
  double slid_m = 0;               // length of the slide on the surface [m]; shorter than asked for at the border
  double depth_m = 0;              // of the press [m]
  double approach_m = 0;           // how far from the surface the path begins [m]; shorter than asked for if not free
  std::vector<std::string> notes;  // in words: what is not as asked (a short slide, a short approach)
};

// The start is the wished one, or on the largest connected piece of the object that the tool can come to. Each phase
// starts and ends at rest (minimum jerk), so speed has no jumps. The approach comes along `toward` or against the
// normal; the press goes in and the retreat out along the normal, or, where the object is in the way, in the direction
// in which there is most room; where that is less than wished, approach and retreat are shorter. Lengths that were not
// asked for fit the object (path_fit.hpp). Refuses (Error kBadInput): a request that is not finite or has no duration
// or approach, a direction that is zero, a slide along the normal or of many volumes' length, an approach from inside
// the object, no surface near the wished start, and a volume in which no ray meets a surface.
[[nodiscard]] TouchPath buildTouchPath(const SurfaceField& field, const PathRequest& request);

}  // namespace palpate
