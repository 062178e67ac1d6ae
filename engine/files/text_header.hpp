// SPDX-License-Identifier: Apache-2.0
// engine/files/text_header.hpp: the "key: value" or "key = value" lines at the head of NRRD and MetaImage files. They
// are read here because they must be checked before a library sees the file. Private to engine/files. Any thread.
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
  std::map<std::string, std::string> fields;  // lower-case keys, trimmed values; of a repeated key the first
  std::uint64_t data_offset = 0;              // first byte after the header [byte]
  std::string fault;  // why a library might read the header in another way: "it has no end"; "": no reason

  [[nodiscard]] std::string text(const std::string& key) const;  // "" if it is missing
  // Every number of a value. Brackets and commas count as blanks. A word that is not a number becomes NaN.
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
};

enum class TextFormat { kNrrd, kMeta };

// Reads lines up to the end of the header, at most 1 MiB. The header of a NRRD file ends with an empty line, or with
// "data file: LIST", which file names follow. That of a MetaImage file ends with the line that says where the data are.
// The header has a fault if a line is neither a field nor a comment, a key comes twice, or the end is missing. (A NRRD
// header whose data are in other files may end with its file.) Throws Error(kIo) if the file cannot be read.
[[nodiscard]] TextHeader readTextHeader(const std::string& path, const std::string& source, TextFormat format);

[[nodiscard]] std::string lowerCase(std::string text);

// The Error for a file that the system cannot open or read. `what`: the words for the file: "it", "slice a.dcm".
[[nodiscard]] Error cannotRead(const std::string& source, const std::string& what, const std::error_code& why);

// Throws cannotRead() unless the file can be opened: a library, or who looks at its content, would call it damaged.
void checkOpens(const std::string& path, const std::string& source, const std::string& what);

// Size of a file [byte]. Throws Error(kNotFound).
[[nodiscard]] std::uint64_t fileBytes(const std::string& path, const std::string& source);

// Throws Error(kBadInput) for a file of 0 bytes. `what`: as above.
void refuseEmpty(const std::string& path, const std::string& source, const std::string& what);

// Throws Error(kBadInput) unless `stored` bytes can hold `wanted` bytes, so that a false header is found before memory
// is filled. Compressed, they can hold 1032 times as much, the most that deflate can pack.
void checkStoredBytes(const std::string& source, double stored, double wanted, bool compressed);

}  // namespace palpate
