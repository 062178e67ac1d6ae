// SPDX-License-Identifier: Apache-2.0
// apps/edit/script_reader.hpp: reads edits as text, one a line, from a file, a pipe or standard input, and passes them
// to an edit queue.
//
// A line that is no valid command goes into the queue too, with the error, so that the error is reported in its turn.
// Thread: any one. It waits while the queue is full, so a script of any length needs the memory of one line. Cost: some
// 1 us a line.
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

// An order from a text, valid or not. `place`: where the text comes from, for messages. A relative path of a mesh file
// is taken from `folder`.
[[nodiscard]] EditOrder editOrder(std::string_view text, const std::string& place,
                                  const std::filesystem::path& folder = {});

class ScriptReader {
 public:
  // Opens the script; "-": standard input. Relative paths of mesh files are taken from the script's folder. Throws
  // Error: kNotFound, kBadInput (a folder), kIo.
  explicit ScriptReader(const std::string& name);
  ~ScriptReader();
  ScriptReader(const ScriptReader&) = delete;
  ScriptReader& operator=(const ScriptReader&) = delete;

  // Reads until the script ends, the queue is abandoned, or `stopped` returns true; it is asked ten times a second
  // while no input comes. Throws Error(kIo) if reading fails.
  void giveTo(EditQueue& queue, const std::function<bool()>& stopped);

  // The fraction of the script that has been read; 0 if its length is unknown. Any thread.
  [[nodiscard]] double fraction() const noexcept;

 private:
  [[nodiscard]] bool waitForBytes(const EditQueue& queue, const std::function<bool()>& stopped) const;
  [[nodiscard]] bool give(EditQueue& queue);  // line_
  void take(char byte);

  std::string name_;
  std::filesystem::path folder_;
  int descriptor_ = 0;
  std::string line_;
  bool too_long_ = false;
  std::size_t number_ = 0;  // of complete lines
  std::size_t size_ = 0;    // of a plain file [byte]
  std::atomic<std::size_t> read_ = 0;
};

}  // namespace palpate
