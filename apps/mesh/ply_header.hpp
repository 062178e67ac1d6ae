// SPDX-License-Identifier: Apache-2.0
// apps/mesh/ply_header.hpp: reads the header of a PLY file. Private to apps/mesh. Any thread.
//
// Source: G. Turk, "The PLY Polygon File Format", 1994 (http://paulbourke.net/dataformats/ply). Lines may end in LF,
// CR LF or CR. Types may have either of their names ("uchar" or "uint8").
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
  std::optional<PlyType> count_type;  // type of a list's length, an integer; empty: the property is no list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  // at least one, unless the count is 0

  // The index of a property; empty if there is none of this name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyForm form = PlyForm::kText;
  char line_end = '\n';  // of text; a CR before an LF counts as a blank
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  // length of the header; the values follow
};

// `bytes`: the file, or at least its first kLongestPlyHeader + 1 bytes. Throws Error(kBadInput), which names `file`: no
// PLY file, a header without an end, an invalid line, an element or property that comes twice.
inline constexpr std::size_t kLongestPlyHeader = 65536;
[[nodiscard]] PlyHeader plyHeader(std::string_view bytes, const std::string& file);

}  // namespace palpate
