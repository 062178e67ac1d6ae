// SPDX-License-Identifier: Apache-2.0
// apps/report/scene_json.hpp: a scene as JSON, with the keys, units and words of a scene file. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/scene/scene.hpp"

namespace palpate {

// Every option of the table, in nested objects as a scene file nests them: {"servo": {"n": 5, ...}, ...}. Null for a
// number, size, direction, point or table that was not given. "objects": each as --object takes it.
[[nodiscard]] nlohmann::ordered_json sceneJson(const Scene& scene);

}  // namespace palpate
