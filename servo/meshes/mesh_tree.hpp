// SPDX-License-Identifier: Apache-2.0
// servo/meshes/mesh_tree.hpp: a search tree over the triangles of a mesh. Private to servo/meshes. The one tree is
// Embree's, in the module "embree" (base/module.hpp). The servo asks it, so its queries use no heap, lock or system
// call. Frame: any that has the mesh near its origin [m], since everything is in float. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/vec.hpp"

namespace palpate {

// Of triangles that a line meets, counts only those whose front it meets.
struct FrontFaces {
  std::span<const Vec3> normals;  // of all triangles, in any frame
  Vec3 way;                       // of the line, in the same frame
};

class MeshTree {
 public:
  virtual ~MeshTree() = default;

  // The triangle that the line from `from` to `from + way` meets first. `only` may be null.
  [[nodiscard]] virtual std::optional<unsigned> firstMet(const Eigen::Vector3f& from, const Eigen::Vector3f& way,
                                                         const FrontFaces* only) const noexcept = 0;

  // Calls visit(search, triangle) for the triangles near x. It returns the radius beyond which no triangle matters any
  // more [m], or nothing where that has not changed.
  using Visit = std::optional<float> (*)(void* search, unsigned triangle);
  virtual void visitNear(const Eigen::Vector3f& x, Visit visit, void* search) const noexcept = 0;
};

struct EmbreeModule {
  static constexpr const char* kModule = "embree";
  static constexpr const char* kTable = "palpate_embree";

  // Every triangle is three numbers of vertices. Throws Error(kOutOfMemory, `name`) where the tree cannot be built.
  std::unique_ptr<MeshTree> (*build)(std::span<const Eigen::Vector3f> vertices,
                                     std::span<const std::array<std::uint32_t, 3>> triangles, const std::string& name);
};

}  // namespace palpate
