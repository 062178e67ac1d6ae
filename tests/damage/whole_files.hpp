// SPDX-License-Identifier: Apache-2.0
// tests/damage/whole_files.hpp: undamaged files of every format that Palpate reads, and by what each format lets damage
// be detected. Thread: one.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/files/volume_file.hpp"

namespace palpate::damage {

// What a format holds by which damage is detected.
struct Promise {
  bool header = false;       // a checksum over its header
  bool values = false;       // a checksum over its values
  bool length = false;       // the length of its values, so that none can be missing or too many
  bool ends = false;         // a mark at its end, so that nothing can be cut off or follow
  bool can_be_lost = false;  // damage may remove the checksum, and then no reader misses it
  bool lines_once = false;   // no line of its header may come twice
};

struct WholeFile {
  std::string name;             // "MetaImage, zlib": the row of the table
  std::string damaged;          // the file of the folder that gets damaged
  std::string loaded;           // what is loaded: a file of the folder; "": the folder
  bool is_mesh = false;         // read by readMeshFile(), else by loadVolume()
  bool header_is_text = false;  // its header consists of lines
  char separator = ':';         // between a key and its value in the header
  Promise promise;
  std::size_t header_bytes = 0;  // length of the damaged file before its values [byte]
  std::function<void(const std::string& folder)> write;
  bool has_values = true;        // false: all values are in another file
  bool has_header = true;        // false: the file holds values and nothing else
  bool values_are_text = false;  // its values are numbers as text: digits are damaged too, not bytes alone
};

// All of them, the variants of each format one after another. `write` writes the same bytes every time.
[[nodiscard]] std::vector<WholeFile> wholeFiles();

}  // namespace palpate::damage
