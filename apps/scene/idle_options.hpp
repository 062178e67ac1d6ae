// SPDX-License-Identifier: Apache-2.0
// apps/scene/idle_options.hpp: finds options that were given although nothing in the scene uses them, so that the user
// is told. One row for each flag, as in option_table.cpp. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/scene/scene.hpp"

namespace palpate {

// A sentence for each given flag that has no effect in this scene: "--hand-mass has no effect: it is that of --hand
// spring".
[[nodiscard]] std::vector<std::string> idleOptions(const Scene& scene, std::span<const std::string> given_flags);

// Every flag that idleOptions() may name.
[[nodiscard]] std::vector<std::string> flagsThatMayBeIdle();

}  // namespace palpate
