// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene_file.hpp: reads a scene's TOML file. Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/scene/scene.hpp"

namespace palpate {

// By which a scene's file is told from a volume's.
inline constexpr const char* kSceneExtension = ".toml";

// Sets in `scene` every key of the file and adds its objects. Relative paths (volume, path.file, device.recording,
// files of objects) are taken from the file's folder. Throws Error: a missing file or a folder; text that is no TOML
// (with line and column); a key that is not in the option table (with the nearest one that is); a value of the wrong
// type or form. Then `scene` is unchanged.
void readSceneFile(const std::filesystem::path& file, Scene& scene);

// The same of a file's text: relative paths are taken from `folder`, and messages name `file`.
void readSceneText(std::string_view text, const std::string& file, const std::filesystem::path& folder, Scene& scene);

}  // namespace palpate
