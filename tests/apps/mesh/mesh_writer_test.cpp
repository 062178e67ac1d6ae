// SPDX-License-Identifier: Apache-2.0
// Files are read back by readMeshFile(), and by Assimp, so that writer and reader cannot share a mistake.
#include "apps/mesh/mesh_writer.hpp"

#include <array>
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

// The normal is at right angles to both edges, though no corner lies at the origin.
TEST(MeshWriterStl, NormalsAreAcrossTheirTriangles) {
  std::string bytes;
  writeMesh(tetrahedron(), "a.stl", 1, [&](std::string_view piece) { bytes += piece; });
  std::array<float, 12> n = {};
  std::memcpy(n.data(), bytes.data() + 84 + 2 * 50, sizeof n);
  const Vec3 normal(n[0], n[1], n[2]), a(n[3], n[4], n[5]), b(n[6], n[7], n[8]), c(n[9], n[10], n[11]);
  // Floats below 1: each is off by 2^-25 at most, so each of the three products by less than 1e-7.
  EXPECT_NEAR(normal.dot(b - a), 0, 3e-7);
  EXPECT_NEAR(normal.dot(c - a), 0, 3e-7);
}

template <class... Numbers>
std::string bytesOf(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

std::string written(const TriangleMesh& mesh, const std::string& name, double units_per_metre) {
  std::string bytes;
  writeMesh(mesh, name, units_per_metre, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

// Whole files, written down by hand. The second triangle has no area and so no normal.
TEST(MeshWriterBytes, AreThoseOfTheFormats) {
  const TriangleMesh mesh = {{{1, 2, 4}, {1, 3, 4}, {1, 2, 5}}, {{0, 1, 2}, {2, 0, 2}}};
  const std::uint16_t attribute = 0;
  std::string title = "binary STL, written by Palpate";
  title.resize(80, ' ');
  EXPECT_EQ(written(mesh, "a.stl", 8),
            title + bytesOf(2U, 1.F, 0.F, 0.F, 8.F, 16.F, 32.F, 8.F, 24.F, 32.F, 8.F, 16.F, 40.F, attribute) +
                bytesOf(0.F, 0.F, 0.F, 8.F, 16.F, 40.F, 8.F, 16.F, 32.F, 8.F, 16.F, 40.F, attribute));
  const auto three = [] { return std::string(1, '\3'); };
  EXPECT_EQ(written(mesh, "a.ply", 8),
            "ply\nformat binary_little_endian 1.0\ncomment written by Palpate\nelement vertex 3\nproperty float x\n"
            "property float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n" +
                bytesOf(8.F, 16.F, 32.F, 8.F, 24.F, 32.F, 8.F, 16.F, 40.F) + three() + bytesOf(0, 1, 2) + three() +
                bytesOf(2, 0, 2));
  EXPECT_EQ(written(mesh, "a.obj", 0.5),
            "# written by Palpate\nv 0.5 1 2\nv 0.5 1.5 2\nv 0.5 1 2.5\nf 1 2 3\nf 3 1 3\n");
}

// Neither crumbs nor the whole file at once: 84 bytes and 50 for each triangle, in pieces of some 60 kB.
TEST(MeshWriterBytes, ComeInLargePieces) {
  const TriangleMesh mesh = {{{1, 2, 4}, {1, 3, 4}, {1, 2, 5}}, {3000, {0, 1, 2}}};
  std::vector<std::size_t> pieces;
  writeMesh(mesh, "a.stl", 1, [&](std::string_view piece) { pieces.push_back(piece.size()); });
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_EQ(pieces[0] + pieces[1] + pieces[2], 84U + 50 * 3000);
  for (const std::size_t n : {0, 1}) {
    EXPECT_GT(pieces[n], 60'000U);
    EXPECT_LT(pieces[n], 60'100U);
  }
}

TEST(MeshWriterNames, EndInAFormatInAnyCase) {
  for (const char* name : {"a.stl", "b.STL", "c.oBj", "folder.d/e.ply", ".ply"})
    EXPECT_TRUE(isMeshFileName(name)) << name;
  for (const char* name : {"", "stl", "a.stl.gz", "a.st", "a.vdb", "a.stl/b"})
    EXPECT_FALSE(isMeshFileName(name)) << name;
}

// A float keeps 24 bits: 2^24 + 1 is 2^24. Small triangles at the origin keep their corners, down to the denormals.
TEST(CollapsedTriangles, AreThoseThatFloatsCannotTellApart) {
  const double far = 16777216;
  const TriangleMesh mesh = {{{far, 0, 0},
                              {far + 1, 0, 0},
                              {far, 3, 0},
                              {far + 2, 0, 0},
                              {0, 0, 0},
                              {1e-43, 0, 0},
                              {0, 0, 1e-43},
                              {1, 1, 1},
                              {3, 3, 3},
                              {2, 2, 1}},
                             {{0, 1, 2},  // two corners in one place
                              {2, 0, 1},  // the others of them
                              {0, 3, 2},  // apart by the spacing of floats there
                              {4, 5, 6},  // tiny
                              {4, 7, 8},  // on a line
                              {4, 7, 9},  // no two alike
                              {4, 4, 4}}};
  EXPECT_EQ(collapsedTriangles(mesh, 1024), 4U);
  // 1e-43 / 1024 is no float above 0.
  EXPECT_EQ(collapsedTriangles(mesh, 1.0 / 1024), 5U);
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
