// SPDX-License-Identifier: Apache-2.0
// apps/mesh/ply_header.hpp: what a PLY file says that it holds. Private to apps/mesh. Any thread.
//
// Source: G. Turk, "The PLY Polygon File Format", 1994 (http://paulbourke.net/dataformats/ply). Lines may end in LF, CR
// LF or CR. Both sets of names for types are taken ("uchar" and "uint8").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class PlyForm { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> count_type;  // of a list: how its length is written; never a real number
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  // one at least, unless the count is 0

  // The place of a property, nothing where there is none.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyForm form = PlyForm::kText;
  char line_end = '\n';  // of text; a CR before it is a blank
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  // the values follow
};

// `bytes`: of the whole file, or more than kLongestPlyHeader of them. Throws Error(kBadInput), which names `file`: no
// PLY file, no end of the header, a line that PLY does not have, an element or property that comes twice.
inline constexpr std::size_t kLongestPlyHeader = 65536;
[[nodiscard]] PlyHeader plyHeader(std::string_view bytes, const std::string& file);

}  // namespace palpate
