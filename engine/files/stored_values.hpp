// SPDX-License-Identifier: Apache-2.0
// engine/files/stored_values.hpp: where a file's values lie, how they are coded, and how they are read: exactly as many
// as the header asks for, and every compressed stream to its end and its checksum. Private to engine/files. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/field/value_type.hpp"
#include "engine/files/raw_block.hpp"
#include "engine/files/unpacker.hpp"

namespace palpate {

// One of the files that hold the values. Each holds an equal share; their order is that of the values.
struct StoredPart {
  std::string path;
  std::uint64_t offset = 0;  // where its data begin, packed or not [byte]
};

enum class Coding {
  kBinary,
  kWords,  // decimal text, separated by blanks and commas
  kHex     // two hexadecimal digits for each byte, in any case, blanks anywhere
};

struct StoredValues {
  std::vector<StoredPart> parts;
  Packing packing = Packing::kNone;
  std::optional<std::uint64_t>
      packed_bytes;                 // of a part; empty: the header does not say, so the rest of the file [byte]
  std::uint64_t skip_bytes = 0;     // before the values, after unpacking [byte]
  bool from_end = false;            // not packed, and the last value ends the file; the offset follows from that
  bool swapped = false;             // the file's byte order is not the machine's; decimal text has none
  Coding coding = Coding::kBinary;  // after unpacking
};

// Checks the sizes of the files before memory is filled. Every file must exist. Plain files must have exactly the bytes
// that the values need. Packed files must be able to hold them (deflate packs 1032:1 at most). Returns the values with
// every offset known: `from_end` is resolved. Throws Error(kBadInput or kNotFound, `source`).
[[nodiscard]] StoredValues checkedBySize(StoredValues values, double wanted_bytes, const std::string& source);

// The values as layersOf() takes them; empty unless they are plain bytes in one file.
[[nodiscard]] std::optional<RawBlock> rawBlockOf(const StoredValues& values);

// Fills `to` with values of the type in the machine's byte order. Throws std::runtime_error with words for a message if
// there are too few or too many bytes, a stream is damaged, a word is not a number of the type, or a character is not a
// hexadecimal digit.
void readStored(const StoredValues& values, ValueType type, std::span<char> to);

}  // namespace palpate
