// SPDX-License-Identifier: Apache-2.0
// apps/mesh/obj_file.hpp: reads OBJ files with Assimp, which is in the module "assimp" (base/module.hpp). Private to
// apps/mesh. A damaged file may end the process, so only a child process may read one.
#pragma once

#include <string>

#include "base/triangle_mesh.hpp"

namespace palpate {

struct AssimpModule {
  static constexpr const char* kModule = "assimp";
  static constexpr const char* kTable = "palpate_assimp";
  // Throws Error(kBadInput) for a file that Assimp refuses, and for vertices that are missing or not finite.
  TriangleMesh (*readObj)(const std::string& file);
};

}  // namespace palpate
