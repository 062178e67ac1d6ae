// SPDX-License-Identifier: Apache-2.0
// engine/files/unpacker.hpp: unpacks a gzip or zlib stream in a file and checks all that the stream allows: its end,
// its CRC-32 or Adler-32, its length. Private to engine/files. One thread.
//
// gzip: several members one after another are one stream (RFC 1952, 2.2). Zeros after the last are padding, as for
// gzip(1); anything else is damage. zlib: one stream, nothing after it. Throws std::runtime_error with words for a
// message; bytes that were delivered before are then invalid. Throws std::system_error if the file cannot be opened or
// read.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

enum class Packing { kNone, kGzip, kZlib };  // kZlib: one gzip member too, which MetaIO also accepts

class Unpacker {
 public:
  // Reads `packed_bytes` bytes of the file from `offset` on, or all bytes to its end. kNone: they are plain bytes.
  Unpacker(const std::string& path, std::uint64_t offset, Packing packing,
           std::uint64_t packed_bytes = std::numeric_limits<std::uint64_t>::max());
  ~Unpacker();
  Unpacker(Unpacker&&) noexcept;
  Unpacker& operator=(Unpacker&&) noexcept;

  // Before the first read of a gzip file of which all will be read: unpacks it in one go if it is of a size and a form
  // for that, which takes a quarter of the time and the memory for it until the end. What is delivered stays the same.
  // False: it goes block by block.
  bool unpackWhole();
  // Returns the number of bytes delivered. It is less than `count` only at the end, if all checks hold.
  [[nodiscard]] std::size_t read(char* to, std::size_t count);
  // Reads to the end and returns the number of these bytes.
  std::uint64_t drain();

 private:
  class Input;
  struct State;
  std::unique_ptr<State> state_;
};

// Unpacks a bare deflate stream (RFC 1951), which has neither length nor checksum. Empty if the stream is damaged, ends
// early, would unpack to more than `most_bytes`, or is followed by anything but a single zero byte.
[[nodiscard]] std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes);

// Whether a file begins as gzip does.
[[nodiscard]] bool isGzip(const std::string& path);

}  // namespace palpate
