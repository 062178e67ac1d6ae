// SPDX-License-Identifier: Apache-2.0
#include "apps/mesh/ply_header.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "apps/mesh/words.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{{"char", PlyType::kInt8},
                                                                          {"int8", PlyType::kInt8},
                                                                          {"uchar", PlyType::kUint8},
                                                                          {"uint8", PlyType::kUint8},
                                                                          {"short", PlyType::kInt16},
                                                                          {"int16", PlyType::kInt16},
                                                                          {"ushort", PlyType::kUint16},
                                                                          {"uint16", PlyType::kUint16},
                                                                          {"int", PlyType::kInt32},
                                                                          {"int32", PlyType::kInt32},
                                                                          {"uint", PlyType::kUint32},
                                                                          {"uint32", PlyType::kUint32},
                                                                          {"float", PlyType::kFloat32},
                                                                          {"float32", PlyType::kFloat32},
                                                                          {"double", PlyType::kFloat64},
                                                                          {"float64", PlyType::kFloat64}}};

std::optional<PlyType> typeOf(std::string_view word) {
  const auto* const found = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == word; });
  if (found == kTypes.end()) return {};
  return found->second;
}

bool isReal(PlyType type) {
  return type == PlyType::kFloat32 || type == PlyType::kFloat64;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file)
      : text_(bytes.substr(0, kLongestPlyHeader)), file_(file) {}

  PlyHeader read() {
    if (!text_.starts_with("ply") || nextLine() != "ply") {
      refuse("it is no PLY file: its first line is not \"ply\"", "give an OBJ, STL or PLY file");
    }
    for (bool has_form = false;;) {
      Words words(nextLine());
      const std::string_view first = words.next();
      if (first == "end_header") {
        expectEnd(words);
        if (!has_form) refuse("its PLY header has no format");
        break;
      }
      if (first.empty() || first == "comment" || first == "obj_info") continue;
      if (first == "format") {
        if (std::exchange(has_form, true)) refuse("its PLY header has two formats");
        form(words);
      } else if (first == "element") {
        element(words);
      } else if (first == "property") {
        property(words);
      } else {
        refuseLine();
      }
    }
    for (const PlyElement& element : header_.elements) {
      if (element.count == 0 || !element.properties.empty()) continue;
      refuse(fmt::format("its PLY header gives the element {} no property", inQuotes(element.name)));
    }
    header_.bytes = at_;
    return header_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason,
                           const std::string& remedy = "the file may be damaged: copy or write it again") const {
    throw Error(Error::Code::kBadInput, file_, reason, remedy);
  }
  [[noreturn]] void refuseLine() const { refuse(fmt::format("its PLY header has the line {}", inQuotes(line_))); }

  // The line without trailing blanks.
  std::string_view nextLine() {
    if (at_ == 0 && text_.find('\r') < text_.find('\n')) {
      const std::size_t after = text_.find('\r') + 1;
      if (after >= text_.size() || text_[after] != '\n') header_.line_end = '\r';
    }
    const std::size_t end = text_.find(header_.line_end, at_);
    if (end == std::string_view::npos) refuse("its PLY header has no end");
    line_ = text_.substr(at_, end - at_);
    at_ = end + 1;
    while (!line_.empty() && (line_.back() == ' ' || line_.back() == '\t' || line_.back() == '\r'))
      line_.remove_suffix(1);
    return line_;
  }

  void expectEnd(Words& words) const {
    if (!words.next().empty()) refuseLine();
  }

  void form(Words& words) {
    static constexpr std::pair<std::string_view, PlyForm> kForms[] = {{"ascii", PlyForm::kText},
                                                                      {"binary_little_endian", PlyForm::kLittleEndian},
                                                                      {"binary_big_endian", PlyForm::kBigEndian}};
    const std::string_view word = words.next();
    const auto* known =
        std::find_if(std::begin(kForms), std::end(kForms), [&](const auto& f) { return f.first == word; });
    if (known == std::end(kForms)) refuseLine();
    header_.form = known->second;
    if (words.next() != "1.0") refuseLine();
    expectEnd(words);
  }

  void element(Words& words) {
    PlyElement element;
    element.name = words.next();
    const auto count = numberOf<std::uint64_t>(words.next());
    if (!count) refuseLine();
    expectEnd(words);
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) refuse(fmt::format("its PLY header has two elements {}", inQuotes(element.name)));
    }
    element.count = *count;
    header_.elements.push_back(element);
  }

  void property(Words& words) {
    if (header_.elements.empty()) refuseLine();
    PlyProperty property;
    std::string_view type = words.next();
    if (type == "list") {
      property.count_type = typeOf(words.next());
      if (!property.count_type || isReal(*property.count_type)) refuseLine();
      type = words.next();
    }
    if (!typeOf(type)) refuseLine();
    property.type = *typeOf(type);
    property.name = words.next();
    if (property.name.empty()) refuseLine();
    expectEnd(words);
    PlyElement& element = header_.elements.back();
    if (element.find(property.name)) {
      refuse(fmt::format("its PLY header gives the element {} two properties {}", inQuotes(element.name),
                         inQuotes(property.name)));
    }
    element.properties.push_back(property);
  }

  std::string_view text_, line_;
  const std::string& file_;
  std::size_t at_ = 0;
  PlyHeader header_;
};

}  // namespace

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t n = 0; n < properties.size(); ++n) {
    if (properties[n].name == property) return n;
  }
  return {};
}

PlyHeader plyHeader(std::string_view bytes, const std::string& file) {
  return HeaderReader(bytes, file).read();
}

}  // namespace palpate
