// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/stl_file.hpp"

#include <algorithm>
#include <cstring>
#include <random>

#include <fmt/format.h>

#include "refusal.hpp"
#include "stl_bytes.hpp"

namespace palpate {
namespace stl_file_test {

using testing::HasSubstr;

std::string refusal(std::string_view bytes) {
  return refusalOf(readStl, bytes);
}

// Three vertices for each triangle, of numbers that a float holds and a text has in few digits.
TriangleMesh soup(std::uint32_t triangles) {
  std::mt19937 random(triangles);
  const auto number = [&] { return (static_cast<double>(random() % 2001) - 1000) / 8; };
  TriangleMesh mesh;
  for (std::uint32_t n = 0; n < triangles; ++n) {
    for (int corner = 0; corner < 3; ++corner) mesh.vertices_W.emplace_back(number(), number(), number());
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

void expectSame(const TriangleMesh& mesh, const TriangleMesh& wanted) {
  EXPECT_EQ(mesh.vertices_W, wanted.vertices_W);
  EXPECT_EQ(mesh.triangles, wanted.triangles);
}

TEST(StlFile, TextAndBinaryGiveTheirMesh) {
  for (const std::uint32_t triangles : {1U, 2U, 7U, 100U}) {
    const TriangleMesh mesh = soup(triangles);
    expectSame(readStl(stlText(mesh), "some.file"), mesh);
    expectSame(readStl(stlText(mesh, ""), "some.file"), mesh);
    expectSame(readStl(binaryStl(mesh), "some.file"), mesh);
    expectSame(readStl(binaryStl(mesh, "made by somebody"), "some.file"), mesh);
  }
  EXPECT_TRUE(readStl("solid\nendsolid", "some.file").triangles.empty());
  EXPECT_TRUE(readStl(binaryStl({}, "made by somebody"), "some.file").triangles.empty());
}

// Upper case, all line ends, several solids, and what some writers have for the normal of a triangle without area.
TEST(StlFile, TextInAnyGuise) {
  std::string text = stlText(soup(2), "");
  text.replace(text.find("0 0 1"), 5, "-nan(ind) -1.#IND nan");
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expectSame(readStl("\n " + text + "\n\n", "some.file"), soup(2));
  for (const std::string line_end : {"\r", "\r\n"}) {
    std::string other;
    for (const char c : stlText(soup(3))) other += c == '\n' ? line_end : std::string(1, c);
    expectSame(readStl(other, "some.file"), soup(3));
  }
  EXPECT_EQ(readStl(stlText(soup(2)) + stlText(soup(3)), "some.file").triangles.size(), 5U);
}

// Wherever the text is cut before `endsolid` is whole. After it only the name is shorter.
TEST(StlFile, TextWithoutItsEndIsRefused) {
  const std::string text = stlText(soup(3));
  const std::size_t end = text.find("endsolid") + 8;
  for (std::size_t length = 0; length < end; ++length) {
    ASSERT_NE(refusal(text.substr(0, length)), "") << text.substr(0, length);
  }
  for (std::size_t length = end; length <= text.size(); ++length) {
    expectSame(readStl(text.substr(0, length), "some.file"), soup(3));
  }
  EXPECT_NE(refusal(text + "x"), "");
  EXPECT_THAT(refusal(text.substr(0, text.find("endsolid"))), HasSubstr("it ends where facet or endsolid should be"));
}

// Every word has its place: without any one of them another stands there.
TEST(StlFile, AWordLostIsSeen) {
  const std::string text = stlText(soup(2), "");
  for (std::size_t at = 0; (at = text.find_first_not_of(" \n", at)) != std::string::npos;) {
    const std::size_t end = text.find_first_of(" \n", at);
    std::string lost = text;
    lost.erase(at, end - at);
    ASSERT_NE(refusal(lost), "") << lost;
    at = end;
  }
}

TEST(StlFile, MessagesNameTheLine) {
  std::string text = stlText(soup(2));
  text.replace(text.find("outer"), 5, "inner");
  EXPECT_THAT(refusal(text), HasSubstr("its line 3 has \"inner\" where outer should be"));
  EXPECT_THAT(refusal("\n" + text), HasSubstr("its line 4 has \"inner\" where outer should be"));
  std::replace(text.begin(), text.end(), '\n', '\r');
  EXPECT_THAT(refusal(text), HasSubstr("its line 3 has \"inner\" where outer should be"));
  std::string word = stlText(soup(1));
  word.replace(word.find("vertex") + 7, 1, "z");
  EXPECT_THAT(refusal(word), HasSubstr("where a number should be"));
  for (const std::string value : {"nan", "inf", "-inf"}) {
    std::string endless = "solid\nfacet normal 0 0 0 outer loop vertex " + value;
    endless += " 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet endsolid";
    EXPECT_THAT(refusal(endless), HasSubstr("triangle 0 has a vertex that is not finite"));
  }
}

TEST(StlFile, ABinaryFileOfAnotherLengthIsRefused) {
  const std::string whole = binaryStl(soup(4));
  for (std::size_t length = 0; length < whole.size(); ++length)
    ASSERT_NE(refusal(whole.substr(0, length)), "") << length;
  for (const std::size_t more : {1, 12, 17, 50, 1000}) {
    EXPECT_NE(refusal(whole + std::string(more, '\0')), "") << more;
  }
  EXPECT_THAT(refusal(whole.substr(0, 200)), HasSubstr("it counts 4 triangles, which take 284 bytes, and it has 200"));
  EXPECT_THAT(refusal("once upon a time"), HasSubstr("no STL file"));
  EXPECT_THAT(refusal(whole.substr(0, 84)), HasSubstr("it counts 4 triangles, which take 284 bytes, and it has 84"));
  std::string many = whole;
  const std::uint32_t count = 0xfffffff0U;
  std::memcpy(many.data() + 80, &count, sizeof count);
  EXPECT_THAT(refusal(many), HasSubstr("it counts 4294967280 triangles"));
  std::string endless = whole;
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(endless.data() + 84 + 50 + 12, &infinity, sizeof infinity);
  EXPECT_THAT(refusal(endless), HasSubstr("triangle 1 has a vertex that is not finite"));
}

}  // namespace stl_file_test
}  // namespace palpate
