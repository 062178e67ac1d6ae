// SPDX-License-Identifier: Apache-2.0
// apps/edit/script_reader.hpp: reads edits as text, one a line, from a file, a pipe or standard input, and gives them
// to an edit queue.
//
// A line that makes no command is given too, with what is wrong with it, so that it is told in its turn. Thread: any
// one; it waits where the queue is full, so a script of any length needs the memory of one line. Cost: some 1 us a
// line.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "engine/session/edit_queue.hpp"

namespace palpate {

inline constexpr std::size_t kLongestLine = 8192;  // [byte]

// A text as an order, whether it makes a command or not. `place`: where it stands, for messages. A relative file of a
// mesh starts at `folder`.
[[nodiscard]] EditOrder editOrder(std::string_view text, const std::string& place,
                                  const std::filesystem::path& folder = {});

class ScriptReader {
 public:
  // Opens the script, "-": standard input. A file's meshes are looked for from its own folder. Throws Error: kNotFound,
  // kBadInput (a folder), kIo.
  explicit ScriptReader(const std::string& name);
  ~ScriptReader();
  ScriptReader(const ScriptReader&) = delete;
  ScriptReader& operator=(const ScriptReader&) = delete;

  // Until the script ends or the queue takes no more. While nothing comes `stopped` is asked, ten times a second.
  // Throws Error(kIo) where reading fails.
  void giveTo(EditQueue& queue, const std::function<bool()>& stopped);

  // How much has been read; 0 where nobody knows how much there is. Any thread.
  [[nodiscard]] double fraction() const noexcept;

 private:
  [[nodiscard]] bool waitForBytes(const EditQueue& queue, const std::function<bool()>& stopped) const;
  [[nodiscard]] bool give(EditQueue& queue);  // the line
  void take(char byte);

  std::string name_;
  std::filesystem::path folder_;
  int descriptor_ = 0;
  std::string line_;
  bool too_long_ = false;
  std::size_t number_ = 0;  // of lines that are over
  std::size_t size_ = 0;    // of a plain file [byte]
  std::atomic<std::size_t> read_ = 0;
};

}  // namespace palpate
