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
};

// Reads the files of meshes. Throws Error: what readMeshFile() and the objects refuse; messages name the object.
[[nodiscard]] SceneObjects makeSceneObjects(const std::vector<ObjectSpec>& specs);

// Rz Ry Rx.
[[nodiscard]] Mat3 rotationOf(const Vec3& rotation_deg);

}  // namespace palpate
