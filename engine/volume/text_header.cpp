// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/text_header.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>

#include <fmt/format.h>

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

TextHeader readTextHeader(const std::string& path, const std::string& source, char separator,
                          const std::string& last_key) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(Error::Code::kIo, source, "it cannot be opened", "check its permissions");
  std::string head(kMostHeaderBytes, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  TextHeader header;
  bool all_plain = true, is_first = true;
  std::size_t begin = 0;
  while (begin < head.size()) {
    const std::size_t end = std::min(head.find('\n', begin), head.size());
    const std::string line = trimmed(head.substr(begin, end - begin));
    begin = std::min(end + 1, head.size());
    header.data_offset = begin;
    const std::size_t colon = line.starts_with('#') ? std::string::npos : line.find(separator);
    const std::string key = colon == std::string::npos ? "" : lowerCase(trimmed(line.substr(0, colon)));
    const bool is_last = last_key.empty() ? line.empty() : key == last_key;
    if (colon != std::string::npos) {
      all_plain = header.fields.emplace(key, trimmed(line.substr(colon + 1))).second && all_plain;
    } else if (!is_last && !is_first && !line.starts_with('#')) {
      all_plain = false;
    }
    header.plain = is_last && all_plain;
    if (is_last) break;
    is_first = false;
  }
  return header;
}

std::uint64_t fileBytes(const std::string& path, const std::string& source) {
  std::error_code failure;
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure) {
    throw Error(Error::Code::kNotFound, source, fmt::format("the file {} is not there", path), "check the path");
  }
  return bytes;
}

void checkStoredBytes(const std::string& source, double stored, double wanted, bool compressed) {
  if (stored * (compressed ? kDeflateLimit : 1.0) >= wanted) return;
  throw Error(Error::Code::kBadInput, source,
              fmt::format("its header asks for {:.0f} bytes of voxels, and {:.0f} bytes{} cannot hold them", wanted,
                          stored, compressed ? " of compressed data" : ""),
              "the file is cut short or its header is wrong: copy or write it again");
}

}  // namespace palpate
