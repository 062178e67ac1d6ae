// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/stl_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

#include "apps/mesh/words.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in memory");

constexpr std::size_t kHead = 84;  // 80 bytes of anything and a count
constexpr std::size_t kTriangle = 50;

bool equalInAnyCase(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

std::uint64_t countIn(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHead - sizeof count, sizeof count);
  return count;
}

void addTriangle(const std::array<Vec3, 3>& corners, const std::string& file, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_W.size());
  for (const Vec3& corner : corners) {
    if (!corner.allFinite()) {
      refuse(file, fmt::format("triangle {} has a vertex that is not finite", mesh.triangles.size()), "mend the mesh");
    }
    mesh.vertices_W.push_back(corner);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
}

TriangleMesh readBinary(std::string_view bytes, const std::string& file) {
  TriangleMesh mesh;
  mesh.triangles.reserve(countIn(bytes));
  mesh.vertices_W.reserve(3 * countIn(bytes));
  for (std::size_t at = kHead; at < bytes.size(); at += kTriangle) {
    std::array<float, 12> numbers;  // the normal and three corners
    std::memcpy(numbers.data(), bytes.data() + at, sizeof numbers);
    std::array<Vec3, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) {
      corners[n] = Vec3(numbers[3 * n + 3], numbers[3 * n + 4], numbers[3 * n + 5]);
    }
    addTriangle(corners, file, mesh);
  }
  return mesh;
}

class TextReader {
 public:
  TextReader(std::string_view text, const std::string& file) : text_(text), words_(text), file_(file) {}

  TriangleMesh read() {
    do {
      expect("solid");
      words_.skipLine();  // its name
      std::string_view word = words_.next();
      for (; equalInAnyCase(word, "facet"); word = words_.next()) facet();
      if (!equalInAnyCase(word, "endsolid")) refuseWord(word, "facet or endsolid");
      words_.skipLine();
    } while (!Words(words_).next().empty());
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuseWord(std::string_view word, std::string_view wanted) const {
    if (word.empty()) refuseDamaged(file_, fmt::format("it ends where {} should be", wanted));
    const std::string_view before = text_.substr(0, text_.size() - words_.rest().size());
    const char line_end = text_.find('\n') == std::string_view::npos ? '\r' : '\n';
    refuseDamaged(file_, fmt::format("its line {} has {} where {} should be",
                                     1 + std::count(before.begin(), before.end(), line_end), inQuotes(word), wanted));
  }

  void expect(std::string_view keyword) {
    const std::string_view word = words_.next();
    if (!equalInAnyCase(word, keyword)) refuseWord(word, keyword);
  }

  void facet() {
    expect("normal");
    for (int n = 0; n < 3; ++n) words_.next();  // for a triangle without area writers have their own words
    expect("outer");
    expect("loop");
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) {
      expect("vertex");
      for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = words_.next();
        const auto number = numberOf<double>(word);
        if (!number) refuseWord(word, "a number");
        corner[axis] = *number;
      }
    }
    addTriangle(corners, file_, mesh_);
    expect("endloop");
    expect("endfacet");
  }

  std::string_view text_;
  Words words_;
  const std::string& file_;
  TriangleMesh mesh_;
};

// Judged by its beginning. Binary files may begin with "solid" too, but a text has no zero bytes.
bool isText(std::string_view bytes) {
  return equalInAnyCase(Words(bytes).next(), "solid") && bytes.substr(0, 512).find('\0') == std::string_view::npos;
}

}  // namespace

TriangleMesh readStl(std::string_view bytes, const std::string& file) {
  if (bytes.size() >= kHead && bytes.size() == kHead + kTriangle * countIn(bytes)) return readBinary(bytes, file);
  if (isText(bytes)) return TextReader(bytes, file).read();
  if (bytes.size() < kHead)
    refuseDamaged(file, "it is no STL file: it is shorter than a binary one's head and no text");
  refuseDamaged(file, fmt::format("it counts {} triangles, which take {} bytes, and it has {}", countIn(bytes),
                                  kHead + kTriangle * countIn(bytes), bytes.size()));
}

}  // namespace palpate
