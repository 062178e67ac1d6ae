// SPDX-License-Identifier: Apache-2.0
#include "engine/files/vdb_checksum.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <fstream>
#include <span>
#include <string_view>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr std::string_view kMagic = "palpate1";
constexpr std::size_t kTrailerBytes = 16;

void read(std::ifstream& file, std::span<char> to, const std::string& source) {
  file.read(to.data(), static_cast<std::streamsize>(to.size()));
  if (!file) throw Error(Error::Code::kIo, source, "it cannot be read", "check its permissions and its disk");
}

std::uint32_t checksumOf(std::ifstream& file, std::uint64_t bytes, const std::string& source) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::string block(kBlock, '\0');
  std::uint32_t crc = 0;
  while (bytes > 0) {
    const std::size_t piece = std::min<std::uint64_t>(bytes, kBlock);
    read(file, std::span(block).first(piece), source);
    crc = crc32c(std::string_view(block).substr(0, piece), crc);
    bytes -= piece;
  }
  return crc;
}

}  // namespace

std::string vdbChecksumBytes(std::uint32_t crc) {
  std::string bytes(kMagic);
  const std::uint32_t complement = ~crc;
  bytes.append(reinterpret_cast<const char*>(&crc), sizeof crc);
  bytes.append(reinterpret_cast<const char*>(&complement), sizeof complement);
  return bytes;
}

VdbChecksum checkVdbChecksum(const std::string& path, const std::string& source) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw cannotRead(source, "it", {errno, std::generic_category()});
  const auto bytes = static_cast<std::uint64_t>(file.tellg());
  if (bytes < kTrailerBytes) return VdbChecksum::kMissing;
  file.seekg(static_cast<std::streamoff>(bytes - kTrailerBytes));
  std::string trailer(kTrailerBytes, '\0');
  read(file, trailer, source);
  if (!trailer.starts_with(kMagic)) return VdbChecksum::kMissing;
  file.seekg(0);
  const std::uint32_t crc = checksumOf(file, bytes - kTrailerBytes, source);
  return trailer == vdbChecksumBytes(crc) ? VdbChecksum::kHolds : VdbChecksum::kFails;
}

}  // namespace palpate
