// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene_command.hpp: a scene as a command line. Flags are those of the option table, so that every line
// which is printed for people can be given back to the program. Any thread.
#pragma once

#include <string>

#include "apps/scene/scene.hpp"

namespace palpate {

// The word, quoted if a shell would change or split it.
[[nodiscard]] std::string shellWord(const std::string& word);

// "palpate touch scan.nii.gz --iso 226 --n 10": the volume, a flag for each option that differs from its default, and
// the objects. Given back, each member has the same value, bit for bit, a direction within rounding.
[[nodiscard]] std::string sceneCommand(const std::string& verb, const Scene& scene);

}  // namespace palpate
