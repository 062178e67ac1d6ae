// SPDX-License-Identifier: Apache-2.0
// engine/files/text_header.hpp: the "key: value" or "key = value" lines at the head of NRRD and MetaImage files.
// Private to engine/files. It finds what must be checked before a library sees the file. Any thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.hpp"

namespace palpate {

struct TextHeader {
  std::map<std::string, std::string> fields;  // lower-case keys, trimmed values; the first of a key counts
  std::uint64_t data_offset = 0;              // first byte after the header [byte]
  std::string fault;  // why a library may take it for another than this one does: "it has no end"; "": it may not

  [[nodiscard]] std::string text(const std::string& key) const;  // "" where it is missing
  // Every number of a value, brackets and commas being blanks; words that are no number become NaN.
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
};

enum class TextFormat { kNrrd, kMeta };

// Reads lines until one is empty (NRRD), or says where the data are (MetaImage), or says "data file: LIST" (NRRD; names
// follow), or the file ends. At most 1 MiB is read. The header has a fault if a line is neither a field nor a comment,
// a key comes twice, or no such end was seen; a NRRD header whose data are elsewhere may end with the file. Throws
// Error(kIo) if the file cannot be read.
[[nodiscard]] TextHeader readTextHeader(const std::string& path, const std::string& source, TextFormat format);

[[nodiscard]] std::string lowerCase(std::string text);

// The Error of a file that the system does not open or read. `what`: the file in the message: "it", "slice a.dcm".
[[nodiscard]] Error cannotRead(const std::string& source, const std::string& what, const std::error_code& why);

// Size of a file [byte]. Throws Error(kNotFound).
[[nodiscard]] std::uint64_t fileBytes(const std::string& path, const std::string& source);

// Throws Error(kBadInput) for a file of 0 bytes. `what`: the file in the message, as above.
void refuseEmpty(const std::string& path, const std::string& source, const std::string& what);

// Throws Error(kBadInput) unless `stored` bytes of data are enough for `wanted`; for gzip, 1032:1 is the most that
// deflate can pack. So that a header which lies is found before memory is filled.
void checkStoredBytes(const std::string& source, double stored, double wanted, bool compressed);

}  // namespace palpate
