// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/mesh_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& file, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, file, reason, remedy);
}

// What can be said before Assimp sees the file.
void checkFile(const std::string& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw Error(Error::Code::kNotFound, file, "there is no such file", "check the mesh's path");
  if (!fs::is_regular_file(status)) refuse(file, "it is not a file", "give an OBJ, STL or PLY file");
  std::string ending = fs::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".obj" && ending != ".stl" && ending != ".ply") {
    refuse(file, "its name ends in none of .obj, .stl and .ply", "convert the mesh into one of these formats");
  }
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (bytes == 0) refuse(file, "the file is empty", "give an OBJ, STL or PLY file");
  if (bytes > kLargestMeshFile) {
    refuse(file, fmt::format("the file has {} MiB, and {} MiB is the most", bytes >> 20, kLargestMeshFile >> 20),
           "give a mesh with fewer triangles");
  }
  if (!std::ifstream(file)) throw Error(Error::Code::kIo, file, "the file cannot be read", "check its permissions");
}

// Assimp's words may span lines.
std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text;
}

void add(const aiMesh& part, const std::string& file, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_W.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices_W.emplace_back(v.x, v.y, v.z);
    if (!mesh.vertices_W.back().allFinite()) refuse(file, fmt::format("vertex {} is not finite", i), "mend the mesh");
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // a point or a line
    std::array<std::uint32_t, 3> triangle{};
    for (unsigned corner = 0; corner < 3; ++corner) {
      if (face.mIndices[corner] >= part.mNumVertices) {
        refuse(file, fmt::format("a triangle names vertex {} of {}", face.mIndices[corner], part.mNumVertices),
               "mend the mesh");
      }
      triangle[corner] = first + face.mIndices[corner];
    }
    mesh.triangles.push_back(triangle);
  }
}

TriangleMesh read(const std::string& file) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_SortByPType |
                                                     aiProcess_PreTransformVertices | aiProcess_ValidateDataStructure);
  if (scene == nullptr) {
    refuse(file, fmt::format("the mesh cannot be read ({})", oneLine(importer.GetErrorString())),
           "check that the file is whole and holds triangles");
  }
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add(*scene->mMeshes[i], file, mesh);
  if (mesh.triangles.empty()) refuse(file, "the mesh has no triangles", "give a surface, not points or lines");
  return mesh;
}

}  // namespace

TriangleMesh readMeshFile(const std::string& file) {
  checkFile(file);
  try {
    return read(file);
  } catch (const std::bad_alloc&) {
    throw Error(Error::Code::kOutOfMemory, file, "the mesh does not fit into memory",
                "give a mesh with fewer triangles, or check that the file is whole");
  } catch (const std::length_error&) {
    refuse(file, "the file says of itself that it is larger than it can be", "check that the file is whole");
  }
}

}  // namespace palpate
