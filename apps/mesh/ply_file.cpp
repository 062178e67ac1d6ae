// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "apps/mesh/ply_header.hpp"
#include "apps/mesh/words.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

// The reader's place in the file, for messages.
struct Place {
  const std::string& file;
  const PlyElement* element = nullptr;
  std::uint64_t number = 0;

  [[nodiscard]] std::string says(const std::string& reason) const {
    return fmt::format("of its {} element{} \"{}\", number {} {}", element->count, element->count == 1 ? "" : "s",
                       element->name, number, reason);
  }
  [[noreturn]] void refuse(const std::string& reason, const std::string& remedy) const {
    palpate::refuse(file, says(reason), remedy);
  }
  [[noreturn]] void refuse(const std::string& reason) const { refuseDamaged(file, says(reason)); }
};

// Both sources give the numbers of the elements one after another. A PLY number of any type is exact as a double.
class BinarySource {
 public:
  BinarySource(std::string_view values, bool swapped) : left_(values), swapped_(swapped) {}

  void begin(const Place&) {}
  double number(PlyType type, const Place& place) {
    switch (type) {
      case PlyType::kInt8:
        return take<std::int8_t>(place);
      case PlyType::kUint8:
        return take<std::uint8_t>(place);
      case PlyType::kInt16:
        return take<std::int16_t>(place);
      case PlyType::kUint16:
        return take<std::uint16_t>(place);
      case PlyType::kInt32:
        return take<std::int32_t>(place);
      case PlyType::kUint32:
        return take<std::uint32_t>(place);
      case PlyType::kFloat32:
        return take<float>(place);
      case PlyType::kFloat64:
        return take<double>(place);
    }
    return 0;
  }
  void end(const Place&) {}
  void finish(const std::string& file) {
    if (!left_.empty()) refuseDamaged(file, fmt::format("{} bytes follow all that its header announces", left_.size()));
  }

 private:
  template <class T>
  T take(const Place& place) {
    if (left_.size() < sizeof(T)) place.refuse("is beyond the file's end");
    std::array<char, sizeof(T)> raw;
    std::copy_n(left_.data(), sizeof(T), raw.data());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    left_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(raw);
  }

  std::string_view left_;
  bool swapped_;
};

class TextSource {
 public:
  TextSource(std::string_view values, char line_end) : left_(values), line_end_(line_end) {}

  // Goes to the next line that is not empty.
  void begin(const Place& place) {
    do {
      if (left_.empty()) place.refuse("is beyond the file's end");
      const std::size_t end = left_.find(line_end_);
      if (end == std::string_view::npos) {
        refuse(place.file, "its last line has no end, so that a number may be cut there",
               "copy or write the file again, or end the line if the file is whole");
      }
      line_ = Words(left_.substr(0, end));
      left_.remove_prefix(end + 1);
    } while (Words(line_).next().empty());
  }
  double number(PlyType, const Place& place) {
    const std::string_view word = line_.next();
    if (word.empty()) place.refuse("has too few numbers on its line");
    const auto number = numberOf<double>(word);
    if (!number) place.refuse(fmt::format("has {} where a number should be", inQuotes(word)));
    return *number;
  }
  void end(const Place& place) {
    if (!line_.next().empty()) place.refuse("has too many numbers on its line");
  }
  void finish(const std::string& file) {
    const std::string_view word = Words(left_).next();
    if (!word.empty()) refuseDamaged(file, fmt::format("{} follows all that its header announces", inQuotes(word)));
  }

 private:
  std::string_view left_;
  char line_end_;
  Words line_{""};
};

// The properties of an element that the mesh needs.
struct Taken {
  enum class Kind { kNothing, kVertex, kFace, kStrips };
  Kind kind = Kind::kNothing;
  std::array<std::size_t, 3> xyz = {};
  std::size_t corners = 0;
};

Taken takenOf(const PlyElement& element, const std::string& file) {
  const auto lacks = [&](const char* what) {
    refuse(file, fmt::format("its element \"{}\" has no {}", element.name, what), "write the mesh again");
  };
  Taken taken;
  if (element.count == 0) return taken;
  if (element.name == "vertex") {
    taken.kind = Taken::Kind::kVertex;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto found = element.find(std::string_view("xyz").substr(axis, 1));
      if (!found || element.properties[*found].count_type) lacks("x, y and z");
      taken.xyz[axis] = *found;
    }
  } else if (element.name == "face" || element.name == "tristrips") {
    taken.kind = element.name == "face" ? Taken::Kind::kFace : Taken::Kind::kStrips;
    auto found = element.find("vertex_indices");
    if (!found) found = element.find("vertex_index");
    if (!found || !element.properties[*found].count_type) lacks("list vertex_indices");
    taken.corners = *found;
  }
  return taken;
}

std::uint64_t countOf(const PlyHeader& header, const char* name) {
  for (const PlyElement& element : header.elements) {
    if (element.name == name) return element.count;
  }
  return 0;
}

template <class Source>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Source source, const std::string& file)
      : header_(header), source_(source), file_(file), vertices_(countOf(header, "vertex")) {}

  TriangleMesh read() {
    for (const PlyElement& element : header_.elements) {
      const Taken taken = takenOf(element, file_);
      Place place{file_, &element};
      for (; place.number < element.count; ++place.number) {
        readElement(taken, place);
        take(taken, place);
      }
    }
    source_.finish(file_);
    return std::move(mesh_);
  }

 private:
  // Keeps the scalars, and the list of corners.
  void readElement(const Taken& taken, const Place& place) {
    source_.begin(place);
    const std::vector<PlyProperty>& properties = place.element->properties;
    scalars_.resize(properties.size());
    for (std::size_t n = 0; n < properties.size(); ++n) {
      const PlyProperty& property = properties[n];
      if (!property.count_type) {
        scalars_[n] = source_.number(property.type, place);
        continue;
      }
      const bool are_corners = taken.corners == n && taken.kind > Taken::Kind::kVertex;
      const double count = source_.number(*property.count_type, place);
      if (!(count >= 0) || count != std::floor(count)) place.refuse("has a list with no whole number of items");
      if (are_corners) corners_.clear();
      for (double item = 0; item < count; ++item) {
        const double number = source_.number(property.type, place);
        if (are_corners) corners_.push_back(number);
      }
    }
    source_.end(place);
  }

  void take(const Taken& taken, const Place& place) {
    if (taken.kind == Taken::Kind::kVertex) {
      const auto [x, y, z] = taken.xyz;
      mesh_.vertices_W.emplace_back(scalars_[x], scalars_[y], scalars_[z]);
      if (!mesh_.vertices_W.back().allFinite()) place.refuse("is not finite", "mend the mesh");
    } else if (taken.kind == Taken::Kind::kFace) {
      takeFace(place);
    } else if (taken.kind == Taken::Kind::kStrips) {
      takeStrips(place);
    }
  }

  void takeFace(const Place& place) {
    if (corners_.size() < 3) place.refuse(fmt::format("has {} corners, not three or more", corners_.size()));
    const std::uint32_t first = vertexOf(corners_[0], place);
    std::uint32_t last = vertexOf(corners_[1], place);
    for (std::size_t n = 2; n < corners_.size(); ++n) {
      const std::uint32_t next = vertexOf(corners_[n], place);
      mesh_.triangles.push_back({first, last, next});
      last = next;
    }
  }

  // Every vertex makes a triangle with the two before it; every second triangle is reversed.
  void takeStrips(const Place& place) {
    std::array<std::uint32_t, 2> before = {};
    std::size_t length = 0;
    for (const double corner : corners_) {
      if (corner == -1) {
        length = 0;
        continue;
      }
      const std::uint32_t vertex = vertexOf(corner, place);
      if (length >= 2) {
        mesh_.triangles.push_back({before[length % 2], before[1 - length % 2], vertex});
      }
      before = {before[1], vertex};
      ++length;
    }
  }

  [[nodiscard]] std::uint32_t vertexOf(double number, const Place& place) const {
    if (number >= 0 && number < static_cast<double>(vertices_) && number == std::floor(number)) {
      return static_cast<std::uint32_t>(number);
    }
    place.refuse(fmt::format("names vertex {} of {}", number, vertices_), "mend the mesh");
  }

  const PlyHeader& header_;
  Source source_;
  const std::string& file_;
  std::uint64_t vertices_;
  TriangleMesh mesh_;
  std::vector<double> scalars_, corners_;  // of the element just read
};

}  // namespace

TriangleMesh readPly(std::string_view bytes, const std::string& file) {
  const PlyHeader header = plyHeader(bytes, file);
  const std::string_view values = bytes.substr(header.bytes);
  if (header.form == PlyForm::kText) return BodyReader(header, TextSource(values, header.line_end), file).read();
  const bool swapped = (header.form == PlyForm::kLittleEndian) != (std::endian::native == std::endian::little);
  return BodyReader(header, BinarySource(values, swapped), file).read();
}

}  // namespace palpate
