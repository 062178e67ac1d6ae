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
// Throws Error(kBadInput) for a text that is not UTF-8, as a name of a file may be: TOML holds no other.
[[nodiscard]] std::string sceneText(const Scene& scene, const std::filesystem::path& folder,
                                    std::span<const std::string_view> always = {});

// Words as lines of comments, each with "# " before it. What TOML takes in no comment becomes '?': control characters
// but line breaks, and bytes that are no UTF-8.
[[nodiscard]] std::string tomlComment(std::string_view words);

}  // namespace palpate
