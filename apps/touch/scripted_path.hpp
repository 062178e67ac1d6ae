// SPDX-License-Identifier: Apache-2.0
// apps/touch/scripted_path.hpp: a scene's path: read from its CSV file, or built from the surface. Set-up code.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/path/surface_field.hpp"
#include "apps/path/timed_point.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

struct ScriptedPath {
  SampledPath path;
  std::vector<PathPhase> phases;   // empty for a path from a file
  std::vector<std::string> notes;  // how the path differs from what was asked for, in words
  // Lengths of a built path [m], whether asked for or chosen; empty for a path from a file.
  std::optional<double> depth_m = {}, slide_m = {}, approach_m = {};
  // Where the press of a built path begins [m], and the unit direction of its slide, if it has one.
  std::optional<Vec3> start_W = {}, slide_W = {};
};

[[nodiscard]] ScriptedPath scriptedPath(const Scene& scene, const SurfaceField& surface);

}  // namespace palpate
