// SPDX-License-Identifier: Apache-2.0
// apps/scene/idle_options.hpp: options that were given and that nothing in the scene uses, to be told rather than
// ignored. A row a flag, as in option_table.cpp. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/plan/scene.hpp"

namespace palpate {

// Of these flags, those that change nothing in this scene, each in words: "--hand-mass has no effect: it is that of
// --hand spring".
[[nodiscard]] std::vector<std::string> idleOptions(const Scene& scene, std::span<const std::string> given_flags);

// Every flag that idleOptions() may name.
[[nodiscard]] std::vector<std::string> flagsThatMayBeIdle();

}  // namespace palpate
