// SPDX-License-Identifier: Apache-2.0
// servo/meshes/mesh_object.hpp: a triangle mesh as an object, with its queries on Embree.
//
// Embree finds which triangle is met (mesh_tree.hpp). It works in float, around the mesh's middle, in its robust mode:
// a ray does not slip between triangles that share an edge. The point on the triangle's plane and its normal are
// computed from the double vertices. Float is off by up to some 2e-7 of the mesh's size. A line must begin further than
// that in front of the surface to be sure to meet it (ObjectContacts keeps 1 um). A closed mesh is entered through
// front faces only. A mesh that is not closed is a sheet. It is entered from both sides, and its normal points to the
// side that the line comes from. Frame W: world [m]. Thread: queries from any thread, also the servo's: no heap, lock
// or system call. Cost: some 100 to 300 ns a query.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/triangle_mesh.hpp"
#include "servo/objects/contact_object.hpp"

namespace palpate {

class MeshObject final : public ContactObject {
 public:
  // Set-up only. Throws Error: what prepareMesh() refuses, kOutOfMemory where Embree cannot build its tree, and what
  // loadModule() throws where Embree is not there.
  explicit MeshObject(TriangleMesh mesh, const std::string& name = "mesh");
  ~MeshObject() override;

  [[nodiscard]] std::optional<ObjectEntry> firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept override;
  // On an edge the normal is that of the triangle that faces x more directly. The normal of a sheet points to x's side.
  [[nodiscard]] ObjectPoint nearest(const Vec3& x_W) const noexcept override;
  [[nodiscard]] bool solid() const noexcept override;

  [[nodiscard]] const std::vector<std::string>& notes() const noexcept;  // from prepareMesh()
  [[nodiscard]] const TriangleMesh& mesh() const noexcept;               // as prepared

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
