// SPDX-License-Identifier: Apache-2.0
// Runs the built program as a child process, as a user would, and keeps what it said.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

struct Command {
  std::vector<std::string> arguments{};                            // behind the program's name
  std::filesystem::path folder{};                                  // where it is started
  std::vector<std::pair<std::string, std::string>> environment{};  // in place of what this process has
  std::optional<std::uint64_t> file_size_limit{};                  // of every file that it writes [byte]
  std::optional<std::uint64_t> process_limit{};  // of its user; the superuser, who has no limit, becomes nobody
  std::string output_file{};                     // takes stdout, "" for Outcome::out
  std::string error_file{};                      // takes stderr, "" for Outcome::err
  std::string input_file{};                      // is stdin; "": this process's
  bool output_unread = false;                    // stdout is a pipe whose reader has gone
  std::vector<int> closed{};                     // descriptors 0 to 2 that it does not have
  std::string signal_at{};                       // words on stderr at which `signals` are sent
  std::string signal_with{};                     // a file in `folder` that must be there for it too
  double signal_delay_s = 0;                     // behind the words
  std::vector<int> signals{};
  std::optional<double> signal_after_s{};  // from its start, instead of at words
  double timeout_s = 120;                  // sanitizer builds included; then it is killed
};

struct Outcome {
  int status = -1;  // exit status; -1: ended by a signal
  int signal = 0;   // that ended it
  bool timed_out = false;
  double seconds = 0;      // wall clock
  double signalled_s = 0;  // when the signals were sent, on the same clock
  std::string out, err;
};

[[nodiscard]] Outcome runPalpate(const Command& command);

}  // namespace palpate
