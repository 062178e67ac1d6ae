// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene_file.hpp: reads a scene's TOML file. Any thread.
#pragma once

#include <filesystem>

#include "engine/plan/scene.hpp"

namespace palpate {

// Sets every key of the file in `scene` and adds its objects. Relative paths (volume, path.file, files of objects) are
// taken from the file's folder. Throws Error: a missing file or a folder, text that is no TOML (with line and column),
// a key that the table does not know (with the nearest one that it knows), a value of the wrong kind (text for a
// number) or form. `scene` is then unchanged.
void readSceneFile(const std::filesystem::path& file, Scene& scene);

}  // namespace palpate
