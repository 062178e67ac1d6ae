// SPDX-License-Identifier: Apache-2.0
// apps/path/touch_path.hpp: builds the tool's path from the surface: approach, press, slide, retreat.
//
// World frame [m], seconds. Set-up code, any thread. The same field and request give the same path, bit for bit.
// Cost: the pieces of the object (object_pieces.hpp), the search for a start (start_search.hpp), then about 40 samples
// for each quarter of a voxel slid.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/path/surface_march.hpp"
#include "apps/path/surface_search.hpp"
#include "apps/path/timed_point.hpp"

namespace palpate {

inline constexpr double kPathInterval_s = 2.0e-3;  // between points; longer only for paths of more than 1e6 points

// What a user can ask of the path (Scene holds the same).
struct PathRequest {
  double duration_s = 5;                 // of the whole path [s]
  std::optional<double> approach_m;      // distance from the surface at the start [m]; empty: as path_fit.hpp chooses
  std::optional<double> press_depth_m;   // below the surface while sliding [m]; empty: likewise
  std::optional<double> slide_length_m;  // along the surface [m]; empty: likewise
  OverEdges over_edges = OverEdges::kFollow;
  std::optional<Vec3> toward_W;  // direction in which the tool approaches; empty: chosen
  std::optional<Vec3> start_W;   // a point near the surface where the press begins [m]; empty: chosen
  std::optional<Vec3> slide_W;   // direction of the slide; empty: chosen
};

struct TouchPath {
  std::vector<TimedPoint> points;  // evenly spaced in time, from 0 to the duration exactly; for cubic interpolation
  std::vector<PathPhase> phases;   // approach, press, slide, retreat, without gaps
  SurfaceHit start;                // where the press begins
  Vec3 slide_W = Vec3::Zero();     // unit direction in which the slide begins; zero without a slide [-]
  double slid_m = 0;               // length of the slide on the surface; less than asked for at the border [m]
  double depth_m = 0;              // of the press [m]
  double approach_m = 0;           // distance from the surface at the start; less than asked for if not free [m]
  std::vector<std::string> notes;  // what differs from the request, in words (a short slide, a short approach)
};

// The start is the requested one, or lies on the largest connected piece of the object that the tool can reach. Each
// phase starts and ends at rest (minimum jerk), so the speed has no jumps. The approach comes along `toward_W` or
// against the normal. The press goes in and the retreat out along the normal or, where the object is in the way, in the
// direction with the most room. Where there is less room than requested, approach and retreat are shorter. Lengths that
// were not requested fit the object (path_fit.hpp). Refuses (Error kBadInput): a request that is not finite or has no
// duration or approach, a zero direction, a slide along the normal, a slide of many times the volume's length, an
// approach from inside the object, no surface near the requested start, and a volume in which no ray meets a surface.
[[nodiscard]] TouchPath buildTouchPath(const SurfaceField& field, const PathRequest& request);

}  // namespace palpate
