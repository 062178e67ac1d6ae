// SPDX-License-Identifier: Apache-2.0
// apps/path/path_request.hpp: what a user can ask of a path that is built from the surface (Scene holds the same).
#pragma once

#include <optional>

#include "apps/path/surface_march.hpp"
#include "base/vec.hpp"

namespace palpate {

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

}  // namespace palpate
