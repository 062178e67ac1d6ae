// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/scene_objects.hpp: makes the solid objects that the servo touches from a scene's descriptions.
// Set-up code.
#pragma once

#include <string>
#include <vector>

#include "apps/scene/object_spec.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

struct SceneObjects {
  ContactObjects objects;
  std::vector<std::vector<Vec3>> outlines;  // lines for the picture: edges, circles, a square for a plane; world [m]
  std::vector<std::string> notes;           // remarks on meshes, in words
  std::vector<std::string> names;           // of each object, for messages
};

// Reads mesh files. Throws Error as readMeshFile() and the objects do; messages name the object.
[[nodiscard]] SceneObjects makeSceneObjects(const std::vector<ObjectSpec>& specs);

// Notes on objects that hold the tool's first position inside them: they are not felt until the tool has been outside.
[[nodiscard]] std::vector<std::string> notesOnStart(const SceneObjects& objects, const Vec3& start_W);

}  // namespace palpate
