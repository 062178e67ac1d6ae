// SPDX-License-Identifier: Apache-2.0
#include "engine/files/vdb_claim.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>

#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

using namespace std::string_view_literals;

// A metadatum as OpenVDB writes it: name, type and value, each after its length. The 8 bytes of the value follow.
constexpr std::string_view kRecord = "\x0e\0\0\0file_mem_bytes\x05\0\0\0int64\x08\0\0\0"sv;

}  // namespace

double vdbClaimedBytes(const std::string& path, const std::string& source) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  constexpr std::size_t kWhole = kRecord.size() + sizeof(std::int64_t);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw cannotRead(source, "it", {errno, std::generic_category()});
  double sum = 0;
  std::string text;
  while (file) {
    const std::size_t had = text.size();
    text.resize(had + kBlock);
    file.read(text.data() + had, static_cast<std::streamsize>(kBlock));
    text.resize(had + static_cast<std::size_t>(file.gcount()));
    std::size_t at = 0;
    for (; (at = text.find(kRecord, at)) != std::string::npos && at + kWhole <= text.size(); at += kWhole) {
      std::int64_t bytes = 0;
      std::memcpy(&bytes, text.data() + at + kRecord.size(), sizeof bytes);
      if (bytes > 0) sum += static_cast<double>(bytes);
    }
    // Keeps the bytes that may be the beginning of another record.
    const std::size_t keep = at == std::string::npos ? std::min(text.size(), kWhole - 1) : text.size() - at;
    text.erase(0, text.size() - keep);
  }
  return sum;
}

}  // namespace palpate
