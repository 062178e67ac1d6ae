// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/mesh_file.hpp"

#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/triangle_mesh.hpp"
#include "stl_bytes.hpp"
#include "support/test_meshes.hpp"
#include "temporary_folder.hpp"

// Assimp forgets what it has read so far of a file that it refuses. Without the leak sanitizer nobody calls this.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer looks for this name
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp\n";
}

namespace palpate {
namespace mesh_file_test {

using testing::HasSubstr;

// A box of 2 x 4 x 6 about (1, 2, 3), as files of three kinds would have it.
const TriangleMesh kBox = boxMesh({1, 2, 3}, {2, 4, 6});

std::string objText() {
  std::string text = "# a box\no box\n";
  for (const Vec3& v : kBox.vertices_W) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& t : kBox.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string plyText() {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      kBox.vertices_W.size(), kBox.triangles.size());
  for (const Vec3& v : kBox.vertices_W) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& t : kBox.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

class MeshFile : public testing::Test {
 protected:
  [[nodiscard]] std::string write(const std::string& name, const std::string& bytes) const {
    const std::string file = (folder_.path() / name).string();
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  static std::string refusal(const std::string& file, Error::Code code = Error::Code::kBadInput) {
    try {
      (void)readMeshFile(file);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_THAT(error.what(), testing::StartsWith(file));
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
    return "nothing";
  }

  TemporaryFolder folder_;
};

TEST_F(MeshFile, EveryFormatGivesTheBox) {
  for (const std::string& file : {write("a.obj", objText()), write("b.ply", plyText()), write("c.stl", stlText(kBox)),
                                  write("d.STL", binaryStl(kBox))}) {
    TriangleMesh mesh = readMeshFile(file);
    for (Vec3& v : mesh.vertices_W) v *= 1e-3;
    const PreparedMesh prepared = prepareMesh(mesh, "box");
    EXPECT_TRUE(prepared.closed) << file;
    EXPECT_EQ(prepared.mesh.vertices_W.size(), 8U) << file;
    EXPECT_EQ(prepared.mesh.triangles.size(), 12U) << file;
    EXPECT_NEAR(sixfoldVolume(prepared.mesh), 6 * 48e-9, 1e-15) << file;  // floats in metres: 1e-7 of it
  }
}

TEST_F(MeshFile, PolygonsBecomeTriangles) {
  const TriangleMesh mesh = readMeshFile(write("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  EXPECT_EQ(mesh.vertices_W, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(MeshFile, OneTriangleIsAMesh) {
  const TriangleMesh mesh = readMeshFile(write("t.obj", "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 3 1 2\n"));
  ASSERT_EQ(mesh.triangles.size(), 1U);
  std::vector<Vec3> corners;
  for (const std::uint32_t corner : mesh.triangles[0]) corners.push_back(mesh.vertices_W.at(corner));
  EXPECT_EQ(corners, (std::vector<Vec3>{{7, 8, 10}, {1, 2, 3}, {4, 5, 6}}));
}

// A file without content takes no room on the disk.
TEST_F(MeshFile, TooLargeAFileIsRefusedUnread) {
  const std::string file = write("large.stl", "");
  std::filesystem::resize_file(file, kLargestMeshFile + (std::uintmax_t{512} << 20));
  EXPECT_THAT(refusal(file), HasSubstr("the file has 1536 MiB, and 1024 MiB is the most; "));
}

TEST_F(MeshFile, Refuses) {
  EXPECT_THAT(refusal((folder_.path() / "none.stl").string(), Error::Code::kNotFound),
              HasSubstr("there is no such file"));
  EXPECT_THAT(refusal(folder_.path().string()), HasSubstr("it is not a file"));
  EXPECT_THAT(refusal(write("box.step", objText())), HasSubstr("convert the mesh"));
  EXPECT_THAT(refusal(write("noending", objText())), HasSubstr("ends in none of .obj, .stl and .ply"));
  EXPECT_THAT(refusal(write("empty.obj", "")), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal(write("words.ply", "once upon a time")), HasSubstr("it is no PLY file"));
  EXPECT_THAT(refusal(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n")), HasSubstr(";"));
  EXPECT_THAT(refusal(write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), HasSubstr(";"));
  EXPECT_THAT(refusal(write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")), HasSubstr(";"));
  EXPECT_NE(refusal(write("index.ply",
                          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                          "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                          "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2000000000\n")),
            "nothing");
}

// By readMeshFile() as by the readers, whose own tests try every place.
TEST_F(MeshFile, FilesThatLostSomethingAreRefused) {
  const std::string whole = plyText();
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  EXPECT_NE(refusal(write("short.ply", whole.substr(0, last))), "nothing");
  std::string more = whole;
  more.replace(more.find("element face 12"), 15, "element face 11");
  EXPECT_NE(refusal(write("more.ply", more)), "nothing");
  const std::string text = stlText(kBox);
  EXPECT_NE(refusal(write("text.stl", text.substr(0, text.find("endsolid")))), "nothing");
  EXPECT_NE(refusal(write("binary.stl", binaryStl(kBox) + "more")), "nothing");
}

// A count of four thousand million in a header of a hundred bytes neither fills the memory nor ends the program.
TEST_F(MeshFile, AbsurdCountsAreRefused) {
  std::string stl = binaryStl(kBox);
  const std::uint32_t many = 0xFFFFFFF0U;
  std::memcpy(stl.data() + 80, &many, sizeof many);
  EXPECT_NE(refusal(write("many.stl", stl)), "nothing");
}

// Bytes changed, taken out and cut off at random: a mesh or an Error, nothing else. 160 files, a few seconds.
TEST_F(MeshFile, DamagedFilesAreReadOrRefused) {
  std::mt19937 random(5);
  const std::pair<const char*, std::string> files[] = {
      {"a.obj", objText()}, {"b.ply", plyText()}, {"c.stl", stlText(kBox)}, {"d.stl", binaryStl(kBox)}};
  for (const auto& [name, whole] : files) {
    for (int i = 0; i < 40; ++i) {
      std::string bytes = whole;
      for (int changes = 1 + i % 4; changes > 0; --changes) {
        const std::size_t at = random() % bytes.size();
        if (i % 3 == 0) bytes[at] = static_cast<char>(random());
        if (i % 3 == 1) bytes.erase(at, 1 + random() % 20);
        if (i % 3 == 2) bytes.resize(at + 1);
      }
      try {
        const TriangleMesh mesh = readMeshFile(write(name, bytes));
        EXPECT_FALSE(mesh.triangles.empty());
        for (const auto& t : mesh.triangles) {
          for (const std::uint32_t corner : t) ASSERT_LT(corner, mesh.vertices_W.size());
        }
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(";"));
      }
    }
  }
}

}  // namespace mesh_file_test
}  // namespace palpate
