// SPDX-License-Identifier: Apache-2.0
// apps/touch/picture.hpp: view.png of a finished run: cameras chosen from the contact, surface drawn by the engine,
// annotated.
#pragma once

#include <functional>
#include <string>

#include "apps/path/surface_field.hpp"
#include "apps/report/touch_run.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

// Bytes of a PNG. Thread: the engine's. Cost: two renderings; on lavapipe a second or two. `between`: called again and
// again; what it throws ends the drawing.
[[nodiscard]] std::string drawPicture(const TouchRun& run, const SurfaceField& surface, Engine& engine,
                                      const std::function<void()>& between);

}  // namespace palpate
