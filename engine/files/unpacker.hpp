// SPDX-License-Identifier: Apache-2.0
// engine/files/unpacker.hpp: bytes out of a gzip or zlib stream in a file, with every check that the stream carries:
// its end, its CRC-32 or Adler-32, its length. Private to engine/files. One thread.
//
// gzip: members one after another are one stream (RFC 1952, 2.2); zeros after the last are padding, as gzip(1) has it,
// anything else is damage. zlib: one stream, nothing after it. Throws std::runtime_error with words for a message; the
// bytes that came before it are then worth nothing. Throws std::system_error where the file cannot be opened or read.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

enum class Packing { kNone, kGzip, kZlib };  // kZlib: or one gzip member, which MetaIO takes as well

class Unpacker {
 public:
  // The packed bytes are those from `offset`, `packed_bytes` of them or as many as there are. kNone: plain bytes.
  Unpacker(const std::string& path, std::uint64_t offset, Packing packing,
           std::uint64_t packed_bytes = std::numeric_limits<std::uint64_t>::max());
  ~Unpacker();
  Unpacker(Unpacker&&) noexcept;
  Unpacker& operator=(Unpacker&&) noexcept;

  // Returns how many bytes came: fewer than `count` only at the end, and there only if all checks held.
  [[nodiscard]] std::size_t read(char* to, std::size_t count);
  // Reads to the end; returns how many bytes that were.
  std::uint64_t drain();

 private:
  class Input;
  struct State;
  std::unique_ptr<State> state_;
};

// A stream of deflate alone (RFC 1951), which has neither length nor checksum, out of its packed bytes. Nothing where
// it is damaged, ends early, would unpack to more than `most_bytes`, or is followed by anything but one byte of 0.
[[nodiscard]] std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes);

// Whether a file begins as gzip does.
[[nodiscard]] bool isGzip(const std::string& path);

}  // namespace palpate
