// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/mesh_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string_view>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& file, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, file, reason, remedy);
}

// Assimp 5.2 reads a PLY header without an end for ever.
void checkPlyHeader(const std::string& file) {
  constexpr std::size_t kMost = 65536;
  std::string head(kMost, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(kMost));
  head.resize(static_cast<std::size_t>(in.gcount()));
  const std::size_t end = head.find("\nend_header");
  const std::size_t after = end + std::string_view("\nend_header").size();
  if (head.starts_with("ply") && end != std::string::npos && after < head.size() &&
      (head[after] == '\n' || head[after] == '\r')) {
    return;
  }
  refuse(file, "the mesh cannot be read (its PLY header has no beginning or no end)", "check that the file is whole");
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
  if (ending == ".ply") checkPlyHeader(file);
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
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
      if (face.mIndices[corner] < part.mNumVertices) continue;
      refuse(file, fmt::format("a face names vertex {} of {}", face.mIndices[corner], part.mNumVertices),
             "mend the mesh");
    }
    for (unsigned corner = 2; corner < face.mNumIndices; ++corner) {  // none of points and lines
      mesh.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[corner - 1], first + face.mIndices[corner]});
    }
  }
}

TriangleMesh read(const std::string& file) {
  // No steps after reading: some of them stop the program at faces that damaged files have.
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
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
