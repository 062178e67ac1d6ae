// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/mesh_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "base/child_process.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& file, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, file, reason, remedy);
}

// How many vertices and faces a PLY header says that there are; Assimp 5.2 does not mind if there are fewer or more.
struct PlyCounts {
  std::optional<std::uint64_t> vertices, faces;
};

std::optional<std::uint64_t> plyCount(const std::string& header, const std::string& element) {
  const std::string line = "\nelement " + element + " ";
  const std::size_t at = header.find(line);
  if (at == std::string::npos) return {};
  return std::strtoull(header.c_str() + at + line.size(), nullptr, 10);
}

// In a PLY file of text every element has a line. `text` is behind the header's end.
void checkPlyLines(const std::string& file, const std::string& header, std::ifstream& text) {
  std::uint64_t said = 0, there = 0;
  for (std::size_t at = header.find("\nelement "); at != std::string::npos; at = header.find("\nelement ", at + 1)) {
    const std::size_t number = header.find(' ', at + std::string_view("\nelement ").size());
    said += std::strtoull(header.c_str() + std::min(number, header.size()), nullptr, 10);
  }
  for (std::string line; std::getline(text, line);)
    there += line.find_first_not_of(" \t\r") != std::string::npos ? 1 : 0;
  if (said == there) return;
  refuse(file,
         fmt::format("its header says that it has {} vertices, faces and the like, and there are {}", said, there),
         "the file may be cut short: copy or write it again");
}

// Nothing for other formats. Assimp 5.2 reads a PLY header without an end for ever.
PlyCounts checkPlyHeader(const std::string& file) {
  constexpr std::size_t kMost = 65536;
  std::string head(kMost, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(kMost));
  head.resize(static_cast<std::size_t>(in.gcount()));
  const std::size_t end = head.find("\nend_header");
  const std::size_t after = end + std::string_view("\nend_header").size();
  if (head.starts_with("ply") && end != std::string::npos && after < head.size() &&
      (head[after] == '\n' || head[after] == '\r')) {
    head.resize(end);
    if (head.find("\nformat ascii") != std::string::npos) {
      in.clear();
      in.seekg(static_cast<std::streamoff>(after));
      std::string rest_of_line;
      std::getline(in, rest_of_line);
      checkPlyLines(file, head, in);
    }
    return {plyCount(head, "vertex"), plyCount(head, "face")};
  }
  refuse(file, "the mesh cannot be read (its PLY header has no beginning or no end)", "check that the file is whole");
}

// What can be said before Assimp sees the file.
PlyCounts checkFile(const std::string& file) {
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
  return ending == ".ply" ? checkPlyHeader(file) : PlyCounts{};
}

void checkCount(const std::string& file, const char* what, std::optional<std::uint64_t> said, std::uint64_t there) {
  if (!said || *said == there) return;
  refuse(file, fmt::format("its header says that it has {} {}, and there are {}", *said, what, there),
         "the file may be cut short: copy or write it again");
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

TriangleMesh read(const std::string& file, const PlyCounts& said) {
  // No steps after reading: some of them stop the program at faces that damaged files have.
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  if (scene == nullptr) {
    refuse(file, fmt::format("the mesh cannot be read ({})", oneLine(importer.GetErrorString())),
           "check that the file is whole and holds triangles");
  }
  TriangleMesh mesh;
  std::uint64_t faces = 0;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    add(*scene->mMeshes[i], file, mesh);
    faces += scene->mMeshes[i]->mNumFaces;
  }
  checkCount(file, "vertices", said.vertices, mesh.vertices_W.size());
  checkCount(file, "faces", said.faces, faces);
  if (mesh.triangles.empty()) refuse(file, "the mesh has no triangles", "give a surface, not points or lines");
  return mesh;
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
  std::memcpy(static_cast<void*>(list.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return list;
}

}  // namespace

TriangleMesh readMeshFile(const std::string& file) {
  constexpr double kMostInMemory = 200;  // bytes for one of a text: Assimp's and ours of a line such as "f 1 2 3"
  const PlyCounts said = checkFile(file);
  const auto bytes = static_cast<double>(fs::file_size(file));
  const ChildOutcome outcome = runInChild(file, 1, limitsForFile(bytes, kMostInMemory * bytes), [&](std::size_t) {
    const TriangleMesh mesh = read(file, said);
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

}  // namespace palpate
