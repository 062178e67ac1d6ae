// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/ply_file.hpp"

#include <cstring>

#include "random_ply.hpp"
#include "refusal.hpp"

namespace palpate {
namespace ply_file_test {

using testing::HasSubstr;

const std::vector<std::string> kAllTypes = {"uchar", "short", "ushort", "int", "uint", "int16", "uint16", "uint32"};

std::string nameOf(RandomPlyForm form) {
  return form == RandomPlyForm::kText ? "Text" : form == RandomPlyForm::kBigEndian ? "BigEndian" : "LittleEndian";
}

std::string refusal(std::string_view bytes) {
  return refusalOf(readPly, bytes);
}

class PlyForms : public testing::TestWithParam<RandomPlyForm> {};

TEST_P(PlyForms, FilesOfAnyLayoutGiveTheirMesh) {
  std::mt19937 random(11);
  for (int n = 0; n < 300; ++n) {
    const RandomPly ply = RandomPlyMaker(random, GetParam()).make(kAllTypes);
    const TriangleMesh mesh = readPly(ply.bytes, "some.file");
    ASSERT_EQ(mesh.vertices_W, ply.mesh.vertices_W) << ply.bytes;
    ASSERT_EQ(mesh.triangles, ply.mesh.triangles) << ply.bytes;
  }
}

// The header says how much there is, so no end can be missing and nothing can follow.
TEST_P(PlyForms, CutOrLengthenedFilesAreRefused) {
  std::mt19937 random(12);
  for (int n = 0; n < 20; ++n) {
    const RandomPly ply = RandomPlyMaker(random, GetParam()).make(kAllTypes);
    for (std::size_t length = 0; length < ply.bytes.size(); ++length) {
      ASSERT_NE(refusal(ply.bytes.substr(0, length)), "") << length << " of " << ply.bytes;
    }
    for (const std::size_t more : {1, 2, 17, 100}) {
      ASSERT_NE(refusal(ply.bytes + std::string(more, static_cast<char>('0' + n % 10))), "") << ply.bytes;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(All, PlyForms,
                         testing::Values(RandomPlyForm::kText, RandomPlyForm::kLittleEndian, RandomPlyForm::kBigEndian),
                         [](const auto& form) { return nameOf(form.param); });

// No face is smaller than a triangle, and everything else has one length. So a mesh of triangles cannot become shorter
// and still be whole, wherever the bytes were.
TEST(PlyFile, BytesLostAmongBinaryValuesAreSeen) {
  std::mt19937 random(13);
  for (int n = 0; n < 4000; ++n) {
    const auto form = n % 2 == 0 ? RandomPlyForm::kLittleEndian : RandomPlyForm::kBigEndian;
    const RandomPly ply = RandomPlyMaker(random, form).make(kAllTypes, true);
    std::string bytes = ply.bytes;
    const std::size_t at = ply.header_bytes + random() % (bytes.size() - ply.header_bytes);
    bytes.erase(at, 1 + random() % 40);
    ASSERT_NE(refusal(bytes), "") << n << ", from byte " << at;
  }
}

std::string withHeader(const std::string& header, const std::string& values = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") {
  return "ply\n" + header + "end_header\n" + values;
}
const std::string kVertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kPlain = "format ascii 1.0\n" + kVertices + kFaces;

// Any line end, blank lines between the values, blanks at their ends, signs.
TEST(PlyFile, TextInAnyGuise) {
  const std::string plain = withHeader(kPlain);
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : plain) text += c == '\n' ? line_end : std::string(1, c);
    const TriangleMesh mesh = readPly(text, "some.file");
    ASSERT_EQ(mesh.vertices_W.size(), 3U);
    EXPECT_EQ(mesh.vertices_W[1], Vec3(1, 0, 0));
    EXPECT_EQ(mesh.triangles.size(), 1U);
  }
  const TriangleMesh mesh =
      readPly(withHeader(kPlain, " 0\t0 0 \n\n+1e0 0 0\n0 1 -0.0\n\n3 0 1 2  \n \n"), "some.file");
  EXPECT_EQ(mesh.vertices_W[1], Vec3(1, 0, 0));
  // Lines of a header that say nothing, blanks behind its first, and an element without properties of which there is
  // none.
  const std::string header = "ply \t\nobj_info x\n\ncomment y\n" + kPlain + "element edge 0\nend_header\n";
  EXPECT_EQ(readPly(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "some.file").triangles.size(), 1U);
}

// A line feed or carriage return may be the first byte of the values; Assimp 5.2 leaves it out.
TEST(PlyFile, ValuesMayBeginWithAnyByte) {
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    for (int first = 0; first < 256; ++first) {
      // After a lone carriage return as line end a line feed is not told from the second half of one: no writer's case.
      if (line_end == "\r" && first == '\n') continue;
      std::string header;
      for (const char c : withHeader("format binary_little_endian 1.0\n" + kVertices + kFaces, "")) {
        header += c == '\n' ? line_end : std::string(1, c);
      }
      std::uint32_t bits = 0x41200000U + static_cast<std::uint32_t>(first);
      float x = 0;
      std::memcpy(&x, &bits, sizeof x);
      std::string values(36 + 13, '\0');
      std::memcpy(values.data(), &x, sizeof x);
      values[36] = 3;
      values[41] = 1;
      values[45] = 2;
      const TriangleMesh mesh = readPly(header + values, "some.file");
      ASSERT_EQ(mesh.vertices_W[0], Vec3(x, 0, 0)) << first;
      ASSERT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2})) << first;
    }
  }
}

// A strip's triangles turn every other time; -1 ends a strip.
TEST(PlyFile, StripsBecomeTriangles) {
  const std::string header =
      "format ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\n";
  const TriangleMesh mesh =
      readPly(withHeader(header, "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 1\n9 0 1 2 3 4 -1 4 3 1\n"), "some.file");
  const std::vector<std::array<std::uint32_t, 3>> wanted = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 1}};
  EXPECT_EQ(mesh.triangles, wanted);
}

TEST(PlyFile, HeadersThatCannotBeAreRefused) {
  const std::string ascii = "format ascii 1.0\n";
  EXPECT_THAT(refusal(""), HasSubstr("no PLY file"));
  EXPECT_THAT(refusal("plyx\n"), HasSubstr("no PLY file"));
  EXPECT_THAT(refusal("ply\n" + ascii + kVertices), HasSubstr("its PLY header has no end"));
  EXPECT_THAT(refusal("ply\n" + std::string(100'000, '\n')), HasSubstr("its PLY header has no end"));
  EXPECT_THAT(refusal(withHeader(kVertices + kFaces)), HasSubstr("no format"));
  EXPECT_THAT(refusal(withHeader(ascii + kPlain)), HasSubstr("two formats"));
  EXPECT_THAT(refusal(withHeader("format ascii 2.0\n" + kVertices + kFaces)), HasSubstr("\"format ascii 2.0\""));
  EXPECT_THAT(refusal(withHeader("format binary 1.0\n" + kVertices + kFaces)), HasSubstr("\"format binary 1.0\""));
  EXPECT_THAT(refusal(withHeader(kPlain + kFaces)), HasSubstr("two elements \"face\""));
  EXPECT_THAT(refusal(withHeader(ascii + kVertices + "property int x\n" + kFaces)), HasSubstr("two properties \"x\""));
  EXPECT_THAT(refusal(withHeader(ascii + "property int x\n")), HasSubstr("\"property int x\""));
  EXPECT_THAT(refusal(withHeader(kPlain + "property flaot w\n")), HasSubstr("\"property flaot w\""));
  EXPECT_THAT(refusal(withHeader(kPlain + "property list float int w\n")), HasSubstr("list float int"));
  EXPECT_THAT(refusal(withHeader(kPlain + "element edge -1\n")), HasSubstr("\"element edge -1\""));
  EXPECT_THAT(refusal(withHeader(kPlain + "element edge 1 2\n")), HasSubstr("\"element edge 1 2\""));
  for (const char* line :
       {"end_header x\n", "format ascii 1.0 x\n", "property float x y\n", "property list int int\n"}) {
    EXPECT_THAT(refusal("ply\n" + ascii.substr(0, line[0] == 'f' ? 0 : ascii.size()) + "element vertex 1\n" + line),
                HasSubstr("its PLY header has the line \"" + std::string(line, std::strlen(line) - 1) + "\""));
  }
  EXPECT_THAT(refusal(withHeader(kPlain + "element edge 1\n")), HasSubstr("\"edge\" no property"));
  // Without a property this many elements would be read without a byte.
  EXPECT_THAT(refusal(withHeader(kPlain + "element edge 18446744073709551615\n")), HasSubstr("\"edge\" no property"));
}

TEST(PlyFile, ValuesThatCannotBeAreRefused) {
  const auto text = [](const std::string& values) { return refusal(withHeader(kPlain, values)); };
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n"), HasSubstr("of its 1 element \"face\", number 0 is beyond the file's end"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1\n3 0 1 2\n"),
              HasSubstr("of its 3 elements \"vertex\", number 2 has too few numbers on its line"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0 0\n3 0 1 2\n"), HasSubstr("number 2 has too many numbers on its line"));
  EXPECT_THAT(text("0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n"), HasSubstr("\"x\" where a number should be"));
  EXPECT_THAT(text("0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"), HasSubstr("number 1 is not finite"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), HasSubstr("names vertex 3 of 3"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), HasSubstr("names vertex -1 of 3"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 0.5\n"), HasSubstr("names vertex 0.5 of 3"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), HasSubstr("has 2 corners"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), HasSubstr("no whole number of items"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\nnan 0 1 2\n"), HasSubstr("no whole number of items"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\ninf 0 1 2\n"), HasSubstr("too few numbers"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n4\n"), HasSubstr("\"4\" follows all"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 2"), HasSubstr("its last line has no end"));
  EXPECT_THAT(text("0 0 0\n1 0 0\n0 1 0\n2.5 0 1 2\n"), HasSubstr("no whole number of items"));
  EXPECT_THAT(refusal(withHeader("format ascii 1.0\n" + kFaces, "3 0 0 0\n")), HasSubstr("names vertex 0 of 0"));
  EXPECT_THAT(refusal(withHeader("format ascii 1.0\n" + kVertices + "element face 1\nproperty int vertex_indices\n")),
              HasSubstr("\"face\" has no list vertex_indices"));
  std::string list_y = withHeader(kPlain);
  list_y.replace(list_y.find("float y"), 7, "list int float y");
  EXPECT_THAT(refusal(list_y), HasSubstr("\"vertex\" has no x, y and z"));
  std::string no_z = withHeader(kPlain);
  no_z.replace(no_z.find("float z"), 7, "float w");
  EXPECT_THAT(refusal(no_z), HasSubstr("\"vertex\" has no x, y and z"));
  std::string no_list = withHeader(kPlain);
  no_list.replace(no_list.find("vertex_indices"), 14, "vertices");
  EXPECT_THAT(refusal(no_list), HasSubstr("\"face\" has no list vertex_indices"));
}

}  // namespace ply_file_test
}  // namespace palpate
