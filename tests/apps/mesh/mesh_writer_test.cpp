// SPDX-License-Identifier: Apache-2.0
// Files are read back by readMeshFile(), and by Assimp, so that writer and reader cannot share a mistake.
#include "apps/mesh/mesh_writer.hpp"

#include <cstring>
#include <fstream>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <gmock/gmock.h>

#include "apps/mesh/mesh_file.hpp"
#include "base/error.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace mesh_writer_test {

using ::testing::HasSubstr;

TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {0.3, 0, 0.001}, {0, 0.1, 0}, {-0.2, 0, 1.0 / 3}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

class MeshWriter : public ::testing::TestWithParam<const char*> {};

// Every corner of every triangle is where it was, to the rounding of a float, and in its order.
TEST_P(MeshWriter, GivesBackEveryTriangle) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / GetParam()).string();
  const TriangleMesh mesh = tetrahedron();
  {
    std::ofstream file(path, std::ios::binary);
    writeMesh(mesh, path, 1000, [&](std::string_view bytes) { file << bytes; });
  }
  const TriangleMesh back = readMeshFile(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& other = *scene->mMeshes[0];
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  ASSERT_EQ(other.mNumFaces, mesh.triangles.size());
  for (unsigned n = 0; n < other.mNumFaces; ++n) {
    ASSERT_EQ(other.mFaces[n].mNumIndices, 3U);
    for (unsigned corner = 0; corner < 3; ++corner) {
      const Vec3 wanted = (1000 * mesh.vertices_W[mesh.triangles[n][corner]]).cast<float>().cast<double>();
      const aiVector3D& v = other.mVertices[other.mFaces[n].mIndices[corner]];
      EXPECT_EQ(back.vertices_W[back.triangles[n][corner]], wanted) << n << ' ' << corner;
      EXPECT_EQ(Vec3(v.x, v.y, v.z), wanted) << n << ' ' << corner;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, MeshWriter, ::testing::Values("a.stl", "a.PLY", "a.obj"),
                         [](const auto& test) { return std::string(test.param + 2); });

// 84 bytes and 50 a triangle; the normal points out of the tetrahedron.
TEST(MeshWriterStl, HasItsCountAndNormals) {
  std::string bytes;
  writeMesh(tetrahedron(), "a.stl", 1000, [&](std::string_view piece) { bytes += piece; });
  ASSERT_EQ(bytes.size(), 84U + 4 * 50U);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(count, 4U);
  Eigen::Vector3f normal, a;
  std::memcpy(normal.data(), bytes.data() + 84 + 2 * 50, 12);
  std::memcpy(a.data(), bytes.data() + 84 + 2 * 50 + 12, 12);
  EXPECT_NEAR(normal.norm(), 1, 1e-6);
  EXPECT_GT(normal.dot(a), 0);  // the fourth corner, (0,0,0), lies behind
}

void expectRefused(const TriangleMesh& mesh, const std::string& name, const std::string& words) {
  try {
    writeMesh(mesh, name, 1, [](std::string_view) { FAIL() << "bytes before the refusal"; });
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(MeshWriterRefusals, NameWhatToDo) {
  expectRefused(tetrahedron(), "a.fbx", ".stl, .obj, .ply");
  expectRefused(tetrahedron(), "stl", ".stl, .obj, .ply");
  expectRefused({}, "a.stl", "choose another isovalue");
}

}  // namespace mesh_writer_test
}  // namespace palpate
