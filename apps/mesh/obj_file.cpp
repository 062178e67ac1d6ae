// SPDX-License-Identifier: Apache-2.0
// The module "assimp".
#include "apps/mesh/obj_file.hpp"

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

void add(const aiMesh& part, const std::string& file, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_W.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices_W.emplace_back(v.x, v.y, v.z);
    if (!mesh.vertices_W.back().allFinite()) refuse(file, fmt::format("vertex {} is not finite", i), "mend the mesh");
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
      if (face.mIndices[corner] < part.mNumVertices) continue;
      refuse(file, fmt::format("a face names vertex {} of {}", face.mIndices[corner], part.mNumVertices),
             "mend the mesh");
    }
    for (unsigned corner = 2; corner < face.mNumIndices; ++corner) {  // points and lines give no triangle
      mesh.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[corner - 1], first + face.mIndices[corner]});
    }
  }
}

TriangleMesh readObj(const std::string& file) {
  // No post-processing: some of its steps abort the program at the faces of a damaged file.
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  if (scene == nullptr) {
    refuse(file, fmt::format("the mesh cannot be read ({})", oneLine(importer.GetErrorString())),
           "check that the file is whole and holds triangles");
  }
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add(*scene->mMeshes[i], file, mesh);
  return mesh;
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::AssimpModule palpate_assimp = {palpate::readObj};
