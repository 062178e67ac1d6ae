// SPDX-License-Identifier: Apache-2.0
// base/atomic_file.hpp: writes a file so that it is there whole or not at all.
//
// The text goes to a temporary file beside the target. commit() flushes it to the disk, renames it to the target and
// flushes the folder. Every step is checked. Without commit(), as after an exception, the temporary file is removed and
// an older target stays as it was.
// A killed process leaves its temporary file behind. The next writer of the target removes it (base/part_file.hpp).
// If the target is a symbolic link, it stays one. The file that it points at is written, or made if it is missing.
// Who may read and write a file that is replaced may do so afterwards: its mode stays, and its group where this process
// may give it. A new file has the rights that its writer names.
// Thread: set-up code, one thread per object. Cost: reading the folder's names, a system call for each 64 KiB, and
// waiting for the disk in commit(). At a file size limit the system kills the process with SIGXFSZ. A process that
// ignores that signal gets an Error instead.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "base/leftover.hpp"
#include "base/part_file.hpp"

namespace palpate {

class AtomicFile {
 public:
  // Refuses (Error kIo): a folder that is missing or may not be written; a target that is there but is no plain file,
  // or is a stream (/dev/stdout); links that go round in a circle.
  explicit AtomicFile(std::filesystem::path target, Rights rights = Rights::kUsual);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view text);  // throws Error kIo: disk full, quota, file size limit
  void commit();                      // throws Error kIo; once only

 private:
  void drain();
  [[noreturn]] void fail(const std::string& what, int error) const;
  std::filesystem::path name_;    // as it was given
  std::filesystem::path target_;  // the same, symbolic links followed
  std::filesystem::path temporary_;
  std::string buffer_;
  int descriptor_ = -1;
  Leftover leftover_;  // the temporary file
};

// For a file that is written at the end of long work: throws Error(kIo) now, as AtomicFile's constructor does.
void checkWritable(const std::filesystem::path& target);

// How many files this process has committed so far. Any thread.
[[nodiscard]] std::uint64_t filesWritten() noexcept;

// Whether both names stand for one file, with links followed. The file need not exist. A name may not be empty.
[[nodiscard]] bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b);

// Refuses (Error kBadInput) a file that is named for two of the outputs. Empty names do not count.
void checkOutputsDiffer(std::initializer_list<std::filesystem::path> outputs);

// Writes the whole of `text` and commits it.
void writeFileAtomically(const std::filesystem::path& target, std::string_view text, Rights rights = Rights::kUsual);

}  // namespace palpate
