// SPDX-License-Identifier: Apache-2.0
// tests/damage/whole_files.hpp: undamaged files of every format that Palpate reads, to be damaged, and what each format
// can tell of damage. Thread: one.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/files/volume_file.hpp"

namespace palpate::damage {

// What a format has to tell damage by.
struct Promise {
  bool header = false;       // a checksum over its header
  bool values = false;       // a checksum over its values
  bool length = false;       // of its values, so that none can be missing or too many
  bool ends = false;         // where it ends, so that nothing can be cut off there or follow
  bool can_be_lost = false;  // the checksum, and then nobody looks for it
  bool lines_once = false;   // a line of its header may not come twice
};

struct WholeFile {
  std::string name;      // "MetaImage, zlib": the row of the table
  std::string damaged;   // the file of its folder that is damaged
  std::string loaded;    // what is loaded: a file of the folder; "": the folder
  bool is_mesh = false;  // by readMeshFile(), else by loadVolume()
  bool text = false;     // its header is lines
  char separator = ':';  // of a key and its value there
  Promise promise;
  std::size_t header_bytes = 0;  // of the damaged file, before the values
  std::function<void(const std::string& folder)> write;
  bool has_values = true;  // false: they are all in another file
  bool has_header = true;  // false: it holds values and nothing else
  bool words = false;      // its values are numbers in words: digits are damaged too, not bytes alone
};

// All of them, each format's variants one after another. `write` puts the same bytes there every time.
[[nodiscard]] std::vector<WholeFile> wholeFiles();

}  // namespace palpate::damage
