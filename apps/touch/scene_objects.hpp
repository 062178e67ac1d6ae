// SPDX-License-Identifier: Apache-2.0
// apps/touch/scene_objects.hpp: from what a scene says of its objects to the objects that the servo touches. Set-up
// code.
#pragma once

#include <string>
#include <vector>

#include "engine/plan/object_spec.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

struct SceneObjects {
  ContactObjects objects;
  std::vector<std::vector<Vec3>> outlines;  // lines for the picture: edges, circles, a square of a plane [m]
  std::vector<std::string> notes;           // in words, of meshes
  std::vector<std::string> names;           // of each object, for messages
};

// Reads the files of meshes. Throws Error: what readMeshFile() and the objects refuse; messages name the object.
[[nodiscard]] SceneObjects makeSceneObjects(const std::vector<ObjectSpec>& specs);

// In words: which objects hold the tool's first place inside them, and so are not felt until it has been outside.
[[nodiscard]] std::vector<std::string> notesOnStart(const SceneObjects& objects, const Vec3& start_W);

}  // namespace palpate
