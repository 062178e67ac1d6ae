// SPDX-License-Identifier: Apache-2.0
#include "engine/files/text_header.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>

#include <fcntl.h>
#include <fmt/format.h>

#include "base/descriptor.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostHeaderBytes = 1U << 20U;
constexpr double kDeflateLimit = 1032;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

double toNumber(const std::string& word) {
  double number = 0;
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, code] = std::from_chars(begin, word.data() + word.size(), number);
  const bool all = code == std::errc() && end == word.data() + word.size();
  return all ? number : std::numeric_limits<double>::quiet_NaN();
}

// One line of a header.
struct Line {
  enum Kind { kField, kComment, kEnd, kOdd };
  Kind kind = kOdd;
  std::string key, value;
};

Line lineOf(const std::string& text, TextFormat format, bool is_first) {
  const bool nrrd = format == TextFormat::kNrrd;
  if (nrrd && text.empty()) return {Line::kEnd, "", ""};
  if (nrrd && (is_first || text.starts_with('#'))) return {Line::kComment, "", ""};
  const std::size_t at = text.find_first_of(nrrd ? ":" : "=:");
  if (at == std::string::npos) return {};
  if (nrrd && text.substr(at, 2) == ":=") return {Line::kComment, "", ""};  // a key/value pair of the writer's own
  return {Line::kField, lowerCase(trimmed(text.substr(0, at))), trimmed(text.substr(at + 1))};
}

// Whether the data, or the names of their files, follow this line.
bool namesData(const Line& line, TextFormat format) {
  if (format == TextFormat::kMeta) return line.key == "elementdatafile";
  return (line.key == "data file" || line.key == "datafile") && line.value.starts_with("LIST");
}

void note(TextHeader& header, const std::string& fault) {
  if (header.fault.empty()) header.fault = fault;
}

}  // namespace

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string TextHeader::text(const std::string& key) const {
  const auto found = fields.find(key);
  return found == fields.end() ? std::string() : found->second;
}

std::vector<double> TextHeader::numbers(const std::string& key) const {
  std::vector<double> result;
  std::string word;
  for (const char c : text(key) + ' ') {
    if (std::string(" \t(),").find(c) == std::string::npos) {
      word += c;
    } else if (!word.empty()) {
      result.push_back(toNumber(word));
      word.clear();
    }
  }
  return result;
}

TextHeader readTextHeader(const std::string& path, const std::string& source, TextFormat format) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw cannotRead(source, "it", {errno, std::generic_category()});
  std::string head(kMostHeaderBytes, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  TextHeader header;
  int line_number = 0;
  while (header.data_offset < head.size()) {
    const std::size_t begin = header.data_offset;
    const std::size_t end = std::min(head.find('\n', begin), head.size());
    header.data_offset = std::min(end + 1, head.size());
    const Line line = lineOf(trimmed(head.substr(begin, end - begin)), format, ++line_number == 1);
    if (line.kind == Line::kEnd) return header;
    if (line.kind == Line::kOdd) note(header, fmt::format("line {} of it is no field", line_number));
    if (line.kind != Line::kField) continue;
    if (!header.fields.emplace(line.key, line.value).second) note(header, fmt::format("\"{}\" comes twice", line.key));
    if (namesData(line, format)) return header;
  }
  const bool is_detached = header.fields.contains("data file") || header.fields.contains("datafile");
  const bool is_all = head.size() < kMostHeaderBytes;
  if (format != TextFormat::kNrrd || !is_detached || !is_all) note(header, "it has no end");
  return header;
}

Error cannotRead(const std::string& source, const std::string& what, const std::error_code& why) {
  const bool no_descriptor = why == std::errc::too_many_files_open || why == std::errc::too_many_files_open_in_system;
  return {Error::Code::kIo, source, fmt::format("{} cannot be opened or read: {}", what, why.message()),
          no_descriptor ? kFreeDescriptors : "check the permissions of the file, and its disk"};
}

void checkOpens(const std::string& path, const std::string& source, const std::string& what) {
  const Descriptor opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!opened) throw cannotRead(source, what, {errno, std::generic_category()});
}

std::uint64_t fileBytes(const std::string& path, const std::string& source) {
  std::error_code failure;
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure) {
    throw Error(Error::Code::kNotFound, source, fmt::format("the file {} is not there", path), "check the path");
  }
  return bytes;
}

void refuseEmpty(const std::string& path, const std::string& source, const std::string& what) {
  if (fileBytes(path, source) > 0) return;
  refuse(source, fmt::format("{} is empty: a file of 0 bytes", what), "copy or write the file again");
}

void checkStoredBytes(const std::string& source, double stored, double wanted, bool compressed) {
  if (stored * (compressed ? kDeflateLimit : 1.0) >= wanted) return;
  throw Error(Error::Code::kBadInput, source,
              fmt::format("its header asks for {:.0f} bytes of voxels, and {:.0f} bytes{} cannot hold them", wanted,
                          stored, compressed ? " of compressed data" : ""),
              "the file is cut short or its header is wrong: copy or write it again");
}

}  // namespace palpate
