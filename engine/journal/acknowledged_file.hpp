// SPDX-License-Identifier: Apache-2.0
// engine/journal/acknowledged_file.hpp: a file that holds the number of the newest record on disk. A program that
// watches a session from outside reads it (docs/journal.md).
#pragma once

#include <cstdint>

#include "engine/journal/journal_writer.hpp"

namespace palpate {

class AcknowledgedFile {
 public:
  // If the file cannot be made, nothing is written and nothing is reported: the session does not need it.
  explicit AcknowledgedFile(const char* name);
  ~AcknowledgedFile();
  AcknowledgedFile(const AcknowledgedFile&) = delete;
  AcknowledgedFile& operator=(const AcknowledgedFile&) = delete;
  // Writes the number as text of fixed length, so that a reader never sees half a number. Any thread, one at a time.
  // Cost: a system call.
  void set(std::uint64_t newest) const noexcept;

 private:
  int descriptor_;
};

// Options of the journal that `palpate` keeps. If the environment variable PALPATE_ACKNOWLEDGED names a file, the
// journal writes the number of its newest record there.
[[nodiscard]] JournalOptions watchedJournal();

}  // namespace palpate
