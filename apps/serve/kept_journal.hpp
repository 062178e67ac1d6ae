// SPDX-License-Identifier: Apache-2.0
// apps/serve/kept_journal.hpp: the folder of a service's journal from one start to the next.
//
// A journal that lies there is that of a service that was killed, or that ended with edits which no file holds. Its
// edits are made again, and so are in the next one's journal. Meanwhile both are there, and at each moment it is known
// which one counts: the earlier one, in the folder "earlier" below, until a mark beside the new one is on the disk.
// Nothing else in the folder is touched. It is locked as long as this lives. Set-up code, one thread.
#pragma once

#include <filesystem>

#include "base/descriptor.hpp"

namespace palpate {

class KeptJournal {
 public:
  // Puts an earlier journal aside. Empty: there is none, ever. Throws Error(kIo), also if another service keeps its
  // journal there.
  explicit KeptJournal(const std::filesystem::path& folder);
  // Where the earlier one is now; empty: there is none.
  [[nodiscard]] const std::filesystem::path& earlier() const noexcept { return earlier_; }
  // The new journal holds all that could be read of the earlier one, on the disk: it counts from now on. The earlier
  // one is deleted, or put aside where something of it could not be read; then its new place is returned. Throws
  // Error(kIo): then the earlier one counts.
  std::filesystem::path takeOver(bool was_read_whole);
  // Locks the folder again if somebody has removed it, once it is there anew. Throws Error(kIo) as the constructor.
  void lockAgain();

 private:
  std::filesystem::path folder_, earlier_;
  Descriptor lock_;
};

}  // namespace palpate
