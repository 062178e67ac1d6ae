// SPDX-License-Identifier: Apache-2.0
// engine/files/quiet.hpp: keeps ITK, the libraries under it and OpenVDB from writing to the screen. Private to
// engine/files.
#pragma once

#include <mutex>
#include <sstream>
#include <string>

namespace palpate {

// While one lives, std::cerr and std::cout go into a buffer and the warnings of ITK, its NIfTI library and GDCM are
// off. One at a time in a process; a second waits.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  std::ostringstream chatter_;
  std::streambuf* old_cerr_;
  std::streambuf* old_cout_;
};

// ITK's several lines of description made one short line.
[[nodiscard]] std::string shortReason(const std::string& description);

}  // namespace palpate
