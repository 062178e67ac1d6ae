// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene_words.hpp: a scene as words of the command line, for a run of the program in another process. Any
// thread.
#pragma once

#include <string>
#include <vector>

#include "apps/scene/scene.hpp"

namespace palpate {

// The flags of everything in which the scene differs from the defaults, its objects too. `palpate touch` with these
// words runs the same scene, bit for bit.
[[nodiscard]] std::vector<std::string> sceneWords(const Scene& scene);

}  // namespace palpate
