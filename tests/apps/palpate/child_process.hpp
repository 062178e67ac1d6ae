// SPDX-License-Identifier: Apache-2.0
// Runs the built program as a child process, as a user would, and keeps its output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

struct Command {
  std::vector<std::string> arguments{};                            // after the program's name
  std::string program{};                                           // a copy of it; "": the built one
  std::filesystem::path folder{};                                  // the working directory
  std::vector<std::pair<std::string, std::string>> environment{};  // variables that differ from this process's
  std::optional<std::uint64_t> file_size_limit{};                  // of every file that it writes [byte]
  std::optional<std::uint64_t> process_limit{};  // of its user; root, which has no limit, becomes user nobody
  std::string output_file{};                     // file for stdout; "": Outcome::out
  std::string error_file{};                      // file for stderr; "": Outcome::err
  std::string input_file{};                      // file for stdin; "": this process's
  bool output_unread = false;                    // stdout is a pipe whose reading end is closed
  std::vector<int> closed{};                     // descriptors 0 to 2 that are closed at its start
  std::string signal_at{};                       // words on stderr after which `signals` are sent
  std::string signal_with{};                     // file in `folder` that must exist before they are sent, too
  double signal_delay_s = 0;                     // from these words to the first signal [s]
  std::vector<int> signals{};                    // to be sent to it
  std::optional<double> signal_after_s{};        // instead of words: from the start to the first signal [s]
  double timeout_s = 120;                        // after which it is killed; enough for sanitizer builds [s]
};

struct Outcome {
  int status = -1;  // exit status; -1: ended by a signal
  int signal = 0;   // the signal that ended it; 0: none
  bool timed_out = false;
  double seconds = 0;      // from its start to its end, by the wall clock
  double signalled_s = 0;  // from its start to the signals
  std::string out, err;
};

[[nodiscard]] Outcome runPalpate(const Command& command);

}  // namespace palpate
