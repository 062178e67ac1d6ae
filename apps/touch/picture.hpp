// SPDX-License-Identifier: Apache-2.0
// apps/touch/picture.hpp: view.png of a finished run: chooses cameras from the contact, lets the engine draw the
// surface and annotates it.
#pragma once

#include <functional>
#include <string>

#include "apps/path/surface_field.hpp"
#include "apps/report/touch_run.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

// Bytes of a PNG. Thread: the engine's. Cost: two renderings; on lavapipe a second or two. `between` is called again
// and again, and may throw to cancel.
[[nodiscard]] std::string drawPicture(const TouchRun& run, const SurfaceField& surface, Engine& engine,
                                      const std::function<void()>& between);

}  // namespace palpate
