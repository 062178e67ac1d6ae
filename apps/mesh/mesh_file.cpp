// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/mesh_file.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "apps/mesh/obj_file.hpp"
#include "apps/mesh/ply_file.hpp"
#include "apps/mesh/stl_file.hpp"
#include "base/child_process.hpp"
#include "base/error.hpp"
#include "base/module.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// Checks what can be checked before the file is read. Returns the suffix of its name, in lower case.
std::string checkFile(const std::string& file) {
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
  return ending;
}

std::string bytesOf(const std::string& file) {
  std::string bytes(fs::file_size(file), '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw Error(Error::Code::kIo, file, "the file cannot be read to its end", "check the disk, or copy it again");
  }
  return bytes;
}

template <class T>
void append(std::string& bytes, const std::vector<T>& list) {
  const std::uint64_t count = list.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(list.data()), count * sizeof(T));
}

template <class T>
std::vector<T> take(std::string_view& bytes) {
  std::uint64_t count = 0;
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  std::vector<T> list(count);
  if (count > 0) std::memcpy(static_cast<void*>(list.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return list;
}

TriangleMesh readObjInChild(const std::string& file) {
  constexpr double kMostInMemory = 200;  // bytes for one of a text: Assimp's and ours of a line such as "f 1 2 3"
  const auto bytes = static_cast<double>(fs::file_size(file));
  const AssimpModule& assimp = loadModule<AssimpModule>();  // here: it is not to be loaded after a fork
  const ChildOutcome outcome = runInChild(file, 1, limitsForFile(bytes, kMostInMemory * bytes), [&](std::size_t) {
    const TriangleMesh mesh = assimp.readObj(file);
    std::string packed;
    append(packed, mesh.vertices_W);
    append(packed, mesh.triangles);
    return packed;
  });
  if (outcome.trouble && outcome.trouble->error) throw Error(*outcome.trouble->error);
  if (outcome.trouble) {
    refuse(file, fmt::format("the mesh cannot be read ({})", oneLine(outcome.trouble->words)),
           "check that the file is whole");
  }
  std::string_view packed = outcome.results[0];
  TriangleMesh mesh;
  mesh.vertices_W = take<Vec3>(packed);
  mesh.triangles = take<decltype(mesh.triangles)::value_type>(packed);
  return mesh;
}

}  // namespace

TriangleMesh readMeshFile(const std::string& file) {
  const std::string ending = checkFile(file);
  TriangleMesh mesh = ending == ".ply"   ? readPly(bytesOf(file), file)
                      : ending == ".stl" ? readStl(bytesOf(file), file)
                                         : readObjInChild(file);
  if (mesh.triangles.empty()) refuse(file, "the mesh has no triangles", "give a surface, not points or lines");
  return mesh;
}

}  // namespace palpate
