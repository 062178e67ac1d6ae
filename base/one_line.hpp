// SPDX-License-Identifier: Apache-2.0
// base/one_line.hpp: makes text from outside (a file's name, a key) fit for one line of a terminal.
#pragma once

#include <string>

namespace palpate {

// Every control character becomes '?', so that a name can neither break the line nor steer the terminal.
[[nodiscard]] inline std::string oneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

}  // namespace palpate
