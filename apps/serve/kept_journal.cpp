// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/kept_journal.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/durable_io.hpp"
#include "base/error.hpp"
#include "base/file_lock.hpp"
#include "engine/journal/recovery.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

bool holdsJournal(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(journalFile(folder), ignored);
}

[[noreturn]] void refuseFolder(const fs::path& folder, const std::string& why) {
  throw Error(Error::Code::kIo, folder.string(), fmt::format("the journal there cannot be kept ({})", why),
              "see to the rights of that folder, or name another one with --journal");
}

// The folder may hold other things, which are the user's.
void drop(const fs::path& file) {
  std::error_code failed;
  fs::remove(file, failed);
  if (failed) refuseFolder(file, failed.message());
}

void flush(const fs::path& folder) {
  if (const int failure = flushFolder(folder); failure != 0) refuseFolder(folder, std::strerror(failure));
}

fs::path lockFile(const fs::path& folder) {
  return folder / "in-use";
}

Descriptor lockOf(const fs::path& folder) {
  const fs::path file = lockFile(folder);
  Descriptor lock(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!lock) refuseFolder(folder, std::strerror(errno));
  if (!isOurs(file, lock.get()))
    throw Error(Error::Code::kIo, folder.string(), "another service keeps its journal there",
                "end that service, or name another folder with --journal");
  return lock;
}

}  // namespace

KeptJournal::KeptJournal(const fs::path& folder) : folder_(folder) {
  if (folder_.empty()) return;
  if (const int failure = makeFolder(folder_, Rights::kPrivate); failure != 0)
    refuseFolder(folder_, std::strerror(failure));
  lock_ = lockOf(folder_);
  const fs::path earlier = earlierFolder(folder_);
  std::error_code ignored;
  if (holdsJournal(earlier) && fs::exists(holdsAllMark(folder_), ignored)) {
    drop(journalFile(earlier));
  } else if (holdsJournal(earlier)) {
    drop(journalFile(folder_));  // begun by one that was killed while it made the edits again
  }
  if (!holdsJournal(earlier) && holdsJournal(folder_)) {
    // First the mark: it would say that the journal which is put aside is not needed. But not before the disk has
    // forgotten the one that the mark is about, with its folder: it would count again.
    if (fs::exists(earlier, ignored)) flush(earlier);
    flush(folder_);
    drop(holdsAllMark(folder_));
    flush(folder_);
    if (const int failure = makeFolder(earlier, Rights::kPrivate); failure != 0)
      refuseFolder(earlier, std::strerror(failure));
    std::error_code failed;
    fs::rename(journalFile(folder_), journalFile(earlier), failed);
    if (failed) refuseFolder(folder_, failed.message());
    flush(earlier);
    flush(folder_);
  }
  if (holdsJournal(earlier)) earlier_ = earlier;
}

void KeptJournal::lockAgain() {
  if (!folder_.empty() && !isNameOf(lockFile(folder_), lock_.get())) lock_ = lockOf(folder_);
}

fs::path KeptJournal::takeOver(bool was_read_whole) {
  if (earlier_.empty()) return {};
  writeFileAtomically(holdsAllMark(folder_), "");
  flush(folder_);
  fs::path aside;
  if (was_read_whole) {
    drop(journalFile(earlier_));
  } else {
    aside = putAside(earlier_, folder_);
  }
  std::error_code ignored;
  fs::remove(earlier_, ignored);
  earlier_.clear();
  return aside;
}

}  // namespace palpate
