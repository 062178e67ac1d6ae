// SPDX-License-Identifier: Apache-2.0
// apps/serve/live_setting.hpp: the settings of a scene that may change while it is served, by their keys
// (docs/scene.md): the isovalue, the algorithm, stiffness, damping, renewal of planes, force limit, effects and
// haptization. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/scene/scene.hpp"

namespace palpate {

[[nodiscard]] bool isLiveKey(const std::string& key);
[[nodiscard]] std::vector<std::string> liveKeys();

// The scene with another value. Throws Error(kBadInput): for a key that is none, with the nearest one; for one that
// needs a new start; as setOption() does.
[[nodiscard]] Scene withLiveSetting(const Scene& scene, const std::string& key, const std::string& value);

// Refuses (Error kBadInput) a live setting of `next` that differs from `scene` and is not what its option takes.
void checkLiveSettings(const Scene& scene, const Scene& next);

// What a scene file that was read again changes: the live settings of `wanted`, in `scene`. `others`: gets the keys of
// other options that differ, which need a new start.
[[nodiscard]] Scene withLiveSettings(const Scene& scene, const Scene& wanted, std::vector<std::string>& others);

// "key = value" for each key; without any for all options, the live ones first, each part after a line that begins with
// '#'. Empty for a value that the program chooses. Throws Error(kBadInput) for a key that is none.
[[nodiscard]] std::string settingsText(const Scene& scene, std::span<const std::string> keys);

}  // namespace palpate
