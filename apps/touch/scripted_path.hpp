// SPDX-License-Identifier: Apache-2.0
// apps/touch/scripted_path.hpp: the path of a scene: read from its CSV file, or built from the surface. Set-up code.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/path/surface_field.hpp"
#include "apps/path/timed_point.hpp"
#include "engine/plan/scene.hpp"
#include "servo/devices/sampled_path.hpp"

namespace palpate {

struct ScriptedPath {
  SampledPath path;
  std::vector<PathPhase> phases;   // empty for a path from a file
  std::vector<std::string> notes;  // in words: what is not as asked
  // Of a built path, in metres: what it has, asked for or chosen.
  std::optional<double> depth_m = {}, slide_m = {}, approach_m = {};
};

[[nodiscard]] ScriptedPath scriptedPath(const Scene& scene, const SurfaceField& surface);

}  // namespace palpate
