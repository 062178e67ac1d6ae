// SPDX-License-Identifier: Apache-2.0
// engine/files/quiet.hpp: keeps ITK, the libraries under it and OpenVDB from writing to the screen. Private to their
// modules.
#pragma once

#include <mutex>
#include <sstream>
#include <string>

namespace palpate {

// While a Quiet lives, std::cerr and std::cout go into a buffer. There is one at a time in a module; a second one
// waits. In the program's own process only OpenVDB's module makes any; ITK's does in child processes.
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

// Shortens ITK's description of several lines to one line.
[[nodiscard]] std::string shortReason(const std::string& description);

}  // namespace palpate
