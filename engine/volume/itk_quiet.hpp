// SPDX-License-Identifier: Apache-2.0
// engine/volume/itk_quiet.hpp: keeps ITK and the libraries under it from writing to the screen. Private to engine/volume.
#pragma once

#include <mutex>
#include <sstream>
#include <string>

namespace palpate {

// While one lives, std::cerr and std::cout go into a buffer and the warnings of ITK, its NIfTI library and GDCM are off.
// One at a time in a process; a second waits.
class ItkQuiet {
 public:
  ItkQuiet();
  ~ItkQuiet();
  ItkQuiet(const ItkQuiet&) = delete;
  ItkQuiet& operator=(const ItkQuiet&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  std::ostringstream chatter_;
  std::streambuf* old_cerr_;
  std::streambuf* old_cout_;
};

// ITK's several lines of description made one short line.
[[nodiscard]] std::string oneLine(const std::string& description);

}  // namespace palpate
