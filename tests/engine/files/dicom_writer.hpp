// SPDX-License-Identifier: Apache-2.0
// DICOM files of any elements, written without the library or the reader that
// read them (PS3.5, chapter 7).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/engine/files/samples.hpp"

namespace palpate {

inline constexpr const char* kImplicitDicom = "1.2.840.10008.1.2";

struct WrittenElement;
using WrittenItem = std::map<std::uint32_t, WrittenElement>;  // by tag, which must ascend

struct WrittenElement {
  std::string type;                   // "US"
  std::string text;                   // of a text type, and bytes of OB
  std::vector<std::int64_t> numbers;  // of US, SS, UL and OW; `word_bytes` each
  std::size_t word_bytes = 2;
  std::vector<WrittenItem> items;      // of SQ
  bool open = false;                   // the sequence and its items end with delimiters
  std::vector<std::string> fragments;  // of packed pixels, each of an even length
};

inline WrittenElement textOf(const std::string& type, const std::string& text) {
  WrittenElement element;
  element.type = type;
  element.text = text;
  return element;
}
inline WrittenElement numbersOf(const std::string& type, const std::vector<std::int64_t>& numbers,
                                std::size_t word_bytes = 2) {
  WrittenElement element = textOf(type, "");
  element.numbers = numbers;
  element.word_bytes = word_bytes;
  return element;
}
inline WrittenElement itemsOf(const std::vector<WrittenItem>& items, bool open = false) {
  WrittenElement element = textOf("SQ", "");
  element.items = items;
  element.open = open;
  return element;
}

class DicomWriter {
 public:
  explicit DicomWriter(const std::string& syntax)
      : syntax_(syntax), explicit_(syntax != kImplicitDicom), big_(syntax == kBigEndianDicom) {}

  [[nodiscard]] std::string file(const WrittenItem& set) const {
    DicomFields head;
    head.syntax = syntax_;
    const std::string bytes = elements(set);
    return dicomHead(head) + (syntax_ == kDeflatedDicom ? deflated(bytes) : bytes);
  }

 private:
  [[nodiscard]] std::string word(std::uint64_t number, std::size_t size) const {
    std::string bytes(size, '\0');
    for (std::size_t n = 0; n < size; ++n) bytes[big_ ? size - 1 - n : n] = static_cast<char>(number >> 8U * n & 0xffU);
    return bytes;
  }
  [[nodiscard]] std::string tag(std::uint32_t number) const {
    return word(number >> 16U, 2) + word(number & 0xffffU, 2);
  }

  [[nodiscard]] std::string sequence(const WrittenElement& element) const {
    std::string bytes;
    for (const WrittenItem& item : element.items) {
      const std::string content = elements(item);
      bytes += tag(0xfffee000) + word(element.open ? 0xffffffffU : content.size(), 4) + content;
      if (element.open) bytes += tag(0xfffee00d) + word(0, 4);
    }
    return element.open ? bytes + tag(0xfffee0dd) + word(0, 4) : bytes;
  }

  // An empty item, which might say where frames begin; then the fragments.
  [[nodiscard]] std::string fragments(const WrittenElement& element) const {
    std::string bytes = tag(0xfffee000) + word(0, 4);
    for (const std::string& fragment : element.fragments)
      bytes += tag(0xfffee000) + word(fragment.size(), 4) + fragment;
    return bytes + tag(0xfffee0dd) + word(0, 4);
  }

  [[nodiscard]] std::string value(const WrittenElement& element) const {
    if (element.type == "SQ") return sequence(element);
    if (!element.fragments.empty()) return fragments(element);
    std::string bytes = element.text;
    for (const std::int64_t number : element.numbers)
      bytes += word(static_cast<std::uint64_t>(number), element.word_bytes);
    if (bytes.size() % 2 != 0) bytes += element.type == "UI" || element.type == "OB" ? '\0' : ' ';
    return bytes;
  }

  [[nodiscard]] std::string elements(const WrittenItem& item) const {
    std::string bytes;
    for (const auto& [number, element] : item) {
      const std::string content = value(element);
      const bool open = (element.type == "SQ" && element.open) || !element.fragments.empty();
      const std::uint64_t length = open ? 0xffffffffU : content.size();
      bytes += tag(number);
      if (!explicit_) {
        bytes += word(length, 4);
      } else if (element.type == "SQ" || element.type == "OB" || element.type == "OW") {
        bytes += element.type + std::string(2, '\0') + word(length, 4);
      } else {
        bytes += element.type + word(length, 2);
      }
      bytes += content;
    }
    return bytes;
  }

  std::string syntax_;
  bool explicit_, big_;
};

// What an image has besides its place and its values: one sample, its size and bits, and the words of all its frames.
struct WrittenImage {
  int rows = 2, columns = 3;
  int bits_allocated = 16, bits_stored = 16, high_bit = 15;
  bool is_signed = true;
  std::string meaning = "MONOCHROME2";
  std::vector<std::int64_t> words;
  bool as_words = false;  // pixels of 8 bits are said to be OW
};
inline WrittenItem imageSet(const WrittenImage& image, const std::string& series = "1.2.3.4.5") {
  WrittenItem set;
  set[0x00080016] = textOf("UI", "1.2.840.10008.5.1.4.1.1.2");
  set[0x0020000d] = textOf("UI", "1.2.3.4");
  set[0x0020000e] = textOf("UI", series);
  set[0x00280002] = numbersOf("US", {1});
  set[0x00280004] = textOf("CS", image.meaning);
  set[0x00280010] = numbersOf("US", {image.rows});
  set[0x00280011] = numbersOf("US", {image.columns});
  set[0x00280100] = numbersOf("US", {image.bits_allocated});
  set[0x00280101] = numbersOf("US", {image.bits_stored});
  set[0x00280102] = numbersOf("US", {image.high_bit});
  set[0x00280103] = numbersOf("US", {image.is_signed ? 1 : 0});
  const bool bytes = image.bits_allocated == 8 && !image.as_words;
  set[0x7fe00010] = numbersOf(bytes ? "OB" : "OW", image.words, static_cast<std::size_t>(image.bits_allocated) / 8);
  return set;
}

// A frame packed as RLE, in runs that repeat nothing (PS3.5, annex G): the highest bytes of all words, the next ones,
// ...
inline constexpr const char* kRleDicom = "1.2.840.10008.1.2.5";
inline std::string rleFrame(const std::vector<std::int64_t>& words, std::size_t word_bytes) {
  std::string planes;
  std::vector<double> head = {static_cast<double>(word_bytes)};
  for (std::size_t byte = word_bytes; byte-- > 0;) {
    head.push_back(static_cast<double>(64 + planes.size()));
    for (std::size_t n = 0; n < words.size(); ++n) {
      if (n % 128 == 0) planes += static_cast<char>(std::min<std::size_t>(128, words.size() - n) - 1);
      planes += static_cast<char>(static_cast<std::uint64_t>(words[n]) >> 8U * byte & 0xffU);
    }
    if (planes.size() % 2 != 0) planes += '\0';
  }
  head.resize(16);
  return bytesOf<std::uint32_t>(head) + planes;
}

// The place of an axial slice of pixels of 0.5 x 0.75 mm: elements of the file itself, or of a frame's groups.
inline void placeAt(WrittenItem& set, const std::string& position) {
  set[0x00200032] = textOf("DS", position);
  set[0x00200037] = textOf("DS", "1\\0\\0\\0\\1\\0");
  set[0x00280030] = textOf("DS", "0.75\\0.5");
}
inline void addFrameContent(WrittenItem& groups, const std::string& stack, std::int64_t phase) {
  groups[0x00209111] = itemsOf({{{0x00209056, textOf("SH", stack)}, {0x00209128, numbersOf("UL", {phase}, 4)}}});
}
inline void addPosition(WrittenItem& groups, const std::string& position) {
  groups[0x00209113] = itemsOf({{{0x00200032, textOf("DS", position)}}});
}
inline void addOrientation(WrittenItem& groups, const std::string& orientation = "1\\0\\0\\0\\1\\0") {
  groups[0x00209116] = itemsOf({{{0x00200037, textOf("DS", orientation)}}});
}
inline void addMeasures(WrittenItem& groups) {
  groups[0x00289110] = itemsOf({{{0x00280030, textOf("DS", "0.75\\0.5")}}});
}
inline void addTransformation(WrittenItem& groups, const std::string& slope, const std::string& intercept) {
  groups[0x00289145] = itemsOf({{{0x00281052, textOf("DS", intercept)}, {0x00281053, textOf("DS", slope)}}});
}

}  // namespace palpate
