// SPDX-License-Identifier: Apache-2.0
// engine/journal/byte_stream.hpp: writes numbers and texts as bytes and reads them back: little-endian, without
// padding. A text is its length (32 bits), then its bytes. Any thread.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/vec.hpp"

namespace palpate {

static_assert(std::endian::native == std::endian::little, "journals are little-endian");

class ByteWriter {
 public:
  template <typename Number>
  void add(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    bytes_.append(bytes, sizeof number);
  }
  void add(const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) add(v[axis]);
  }
  void add(const Vec3i& v) {
    for (int axis = 0; axis < 3; ++axis) add(static_cast<std::int32_t>(v[axis]));
  }
  void add(const Mat3& m) {  // column by column
    for (int column = 0; column < 3; ++column) add(Vec3(m.col(column)));
  }
  void add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  void add(const std::string& text) { add(std::string_view(text)); }
  void addRaw(std::string_view bytes) { bytes_ += bytes; }

  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

// Reading past the end yields zeros or an empty text, and from then on good() is false.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <typename Number>
  void get(Number& number) {
    static_assert(std::is_arithmetic_v<Number>);
    number = {};
    const std::string_view bytes = getRaw(sizeof number);
    if (good_) std::memcpy(&number, bytes.data(), sizeof number);
  }
  void get(Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) get(v[axis]);
  }
  void get(Vec3i& v) {
    for (int axis = 0; axis < 3; ++axis) {
      std::int32_t number = 0;
      get(number);
      v[axis] = number;
    }
  }
  void get(Mat3& m) {
    for (int column = 0; column < 3; ++column) {
      Vec3 v;
      get(v);
      m.col(column) = v;
    }
  }
  void get(std::string& text) {
    std::uint32_t size = 0;
    get(size);
    text = getRaw(size);
  }
  [[nodiscard]] std::string_view getRaw(std::size_t size) {
    good_ = good_ && size <= rest_.size();
    if (!good_) return {};
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }

  [[nodiscard]] bool good() const noexcept { return good_; }
  [[nodiscard]] bool atEnd() const noexcept { return good_ && rest_.empty(); }
  [[nodiscard]] std::size_t left() const noexcept { return rest_.size(); }

 private:
  std::string_view rest_;
  bool good_ = true;
};

}  // namespace palpate
