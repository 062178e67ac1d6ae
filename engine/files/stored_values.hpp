// SPDX-License-Identifier: Apache-2.0
// engine/files/stored_values.hpp: where a file's values lie and how they are written there, and reading them whole:
// exactly as many as the header asks for, every compressed stream to its end and its checksum. Private to
// engine/files. Any thread.
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

// A file that holds an equal share of the values with the others, in their order.
struct StoredPart {
  std::string path;
  std::uint64_t offset = 0;  // of its first byte, packed or not [byte]
};

enum class Coding {
  kBinary,
  kWords,  // numbers in words, between blanks and commas
  kHex     // two hexadecimal digits a byte, in any case, blanks anywhere
};

struct StoredValues {
  std::vector<StoredPart> parts;
  Packing packing = Packing::kNone;
  std::optional<std::uint64_t> packed_bytes;  // of a part, where the header says so; all of the file otherwise [byte]
  std::uint64_t skip_bytes = 0;               // before the values, after unpacking [byte]
  bool from_end = false;                      // plain values that end with their file, whatever precedes them
  bool swapped = false;                       // against the machine's byte order; words have none
  Coding coding = Coding::kBinary;            // after unpacking
};

// What can be said from the sizes of files: that each is there, that plain bytes are as many as the values need, no
// fewer and no more, that packed ones may be enough (deflate packs 1032:1 at most). Before memory is filled. Returns
// the values with every offset known: `from_end` is resolved. Throws Error(kBadInput, `source`), kNotFound.
[[nodiscard]] StoredValues checkedBySize(StoredValues values, double wanted_bytes, const std::string& source);

// The one part as layersOf() takes it, where it is plain bytes.
[[nodiscard]] std::optional<RawBlock> rawBlockOf(const StoredValues& values);

// Fills `to` with values of the type in the machine's byte order. Throws std::runtime_error with words for a message:
// too few bytes, too many, a damaged stream, a word that is no number of the type, a letter that is no digit.
void readStored(const StoredValues& values, ValueType type, std::span<char> to);

}  // namespace palpate
