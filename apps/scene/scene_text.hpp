// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene_text.hpp: a scene as the text of a TOML file, which readSceneFile() reads back. Any thread.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "apps/scene/scene.hpp"

namespace palpate {

// Every option that differs from its default, those of the keys `always`, and the objects. Read back, each member has
// the same value, bit for bit, a direction within rounding. `folder`: of the file; paths that are relative to the
// current folder become relative to it, since readSceneFile() takes them so.
[[nodiscard]] std::string sceneText(const Scene& scene, const std::filesystem::path& folder,
                                    std::span<const std::string_view> always = {});

}  // namespace palpate
