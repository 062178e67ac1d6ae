// SPDX-License-Identifier: Apache-2.0
// engine/journal/acknowledged_file.hpp: the newest acknowledged record's number in a file, for who watches a session
// from outside (docs/journal.md).
#pragma once

#include <cstdint>

#include "engine/journal/journal_writer.hpp"

namespace palpate {

class AcknowledgedFile {
 public:
  // A file that cannot be made is left out: it is no part of the session.
  explicit AcknowledgedFile(const char* name);
  ~AcknowledgedFile();
  AcknowledgedFile(const AcknowledgedFile&) = delete;
  AcknowledgedFile& operator=(const AcknowledgedFile&) = delete;
  // As text of one length, so that a reader never sees half of one. Any thread, one at a time. Cost: a system call.
  void set(std::uint64_t newest) const noexcept;

 private:
  int descriptor_;
};

// The journal that `palpate` keeps for a user: with such a file where PALPATE_ACKNOWLEDGED names one.
[[nodiscard]] JournalOptions watchedJournal();

}  // namespace palpate
