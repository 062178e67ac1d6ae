// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/text_raw_block.hpp"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <initializer_list>

namespace palpate {
namespace {

constexpr bool kLittleEndian = std::endian::native == std::endian::little;

bool saysNothingOf(const TextHeader& header, std::initializer_list<const char*> keys) {
  return std::all_of(keys.begin(), keys.end(), [&](const char* key) { return !header.fields.contains(key); });
}

bool says(const TextHeader& header, const char* key, const char* value) {
  return lowerCase(header.text(key)) == value;
}

bool isOneOf(const std::string& text, std::initializer_list<const char*> values) {
  return std::find(values.begin(), values.end(), text) != values.end();
}

// A file of its own beside the header, by its whole name: no list, no pattern.
bool isFileName(const std::string& name) {
  return !name.empty() && name.find_first_of("% \t") == std::string::npos && !lowerCase(name).starts_with("list");
}

std::string beside(const std::string& path, const std::string& name) {
  return (std::filesystem::path(path).parent_path() / name).string();
}

}  // namespace

std::optional<RawBlock> nrrdRawBlock(const TextHeader& header, const std::string& path) {
  const bool packed = !header.plain || !says(header, "encoding", "raw");
  const bool moved = !saysNothingOf(header, {"byte skip", "byteskip", "line skip", "lineskip"});
  const bool turned = !says(header, "endian", "little") || !kLittleEndian || header.numbers("sizes").size() != 3 ||
                      !isOneOf(header.text("kinds"), {"", "domain domain domain", "space space space"});
  if (packed || moved || turned) return {};
  if (saysNothingOf(header, {"data file", "datafile"})) return RawBlock{path, header.data_offset};
  const std::string data = header.text(header.fields.contains("data file") ? "data file" : "datafile");
  if (!isFileName(data)) return {};
  return RawBlock{beside(path, data), 0};
}

std::optional<RawBlock> metaRawBlock(const TextHeader& header, const std::string& path) {
  const bool packed = !header.plain || !says(header, "binarydata", "true") || !says(header, "compresseddata", "false");
  const bool moved = !saysNothingOf(header, {"headersize"});
  const bool turned = !says(header, "binarydatabyteordermsb", "false") || !kLittleEndian ||
                      !saysNothingOf(header, {"elementbyteordermsb"}) || header.numbers("dimsize").size() != 3;
  if (packed || moved || turned) return {};
  const std::string data = header.text("elementdatafile");
  if (lowerCase(data) == "local") return RawBlock{path, header.data_offset};
  if (!isFileName(data)) return {};
  return RawBlock{beside(path, data), 0};
}

}  // namespace palpate
