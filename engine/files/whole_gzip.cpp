// SPDX-License-Identifier: Apache-2.0
#include "engine/files/whole_gzip.hpp"

#include <memory>
#include <new>

#include <libdeflate.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/large_pages.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t kLeastMember = 18;     // header and trailer (RFC 1952, 2.3)
constexpr std::uint64_t kMostUnpacked = 1032;  // unpacked bytes for each packed byte (deflate's limit)

template <class Byte>
std::unique_ptr<Byte[]> room(std::uint64_t count) {
  std::unique_ptr<Byte[]> bytes = std::make_unique_for_overwrite<Byte[]>(count);
  wishLargePages(bytes.get(), count);
  return bytes;
}

// Null if the file has fewer.
std::unique_ptr<unsigned char[]> bytesFrom(int descriptor, std::uint64_t offset, std::uint64_t count) {
  std::unique_ptr<unsigned char[]> bytes = room<unsigned char>(count);
  for (std::uint64_t done = 0; done < count;) {
    const ssize_t got = pread(descriptor, bytes.get() + done, count - done, static_cast<off_t>(offset + done));
    if (got <= 0) return {};
    done += static_cast<std::uint64_t>(got);
  }
  return bytes;
}

// ISIZE, the last four bytes: the length modulo 2^32.
std::uint64_t toldLength(std::span<const unsigned char> packed) {
  std::uint64_t length = 0;
  for (const unsigned char byte :
       {packed[packed.size() - 1], packed[packed.size() - 2], packed[packed.size() - 3], packed[packed.size() - 4]})
    length = length << 8U | byte;
  return length;
}

std::optional<WholeGzip> unpacked(std::span<const unsigned char> packed) {
  const std::uint64_t length = toldLength(packed);
  if (length > kMostWholeGzipBytes || length > kMostUnpacked * packed.size()) return {};
  WholeGzip whole{room<char>(length), length};
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (decompressor == nullptr) return {};
  std::size_t used = 0, made = 0;
  const libdeflate_result result = libdeflate_gzip_decompress_ex(decompressor.get(), packed.data(), packed.size(),
                                                                 whole.bytes.get(), whole.count, &used, &made);
  if (result != LIBDEFLATE_SUCCESS || used != packed.size() || made != whole.count) return {};
  return whole;
}

}  // namespace

std::optional<WholeGzip> wholeGzip(int descriptor, std::uint64_t offset) {
  struct stat facts = {};
  if (fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) return {};
  const auto size = static_cast<std::uint64_t>(facts.st_size);
  if (size < offset + kLeastMember || size - offset > kMostWholeGzipBytes) return {};
  try {
    const std::unique_ptr<unsigned char[]> packed = bytesFrom(descriptor, offset, size - offset);
    if (packed == nullptr) return {};
    return unpacked({packed.get(), size - offset});
  } catch (const std::bad_alloc&) {
    return {};
  }
}

}  // namespace palpate
