// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/session_folders.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/durable_io.hpp"
#include "base/error.hpp"
#include "engine/journal/recovery.hpp"

namespace palpate {
namespace {

constexpr const char* kLock = "lock";

// The lock of a file, if nobody has it; -1: somebody has, or it cannot be opened.
int takeLock(const std::filesystem::path& name, int flags) {
  const int file = open(name.c_str(), flags | O_RDWR | O_CLOEXEC | O_NONBLOCK, 0600);
  if (file < 0) return -1;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  close(file);
  return -1;
}

void removeEmpty(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    files += entry.path().filename() != kLock;
  if (files > 0) return;
  std::filesystem::remove(folder / kLock, ignored);
  std::filesystem::remove(folder, ignored);
}

}  // namespace

// Names sort by time; the process tells apart what begins in one second.
SessionFolder::SessionFolder(const std::filesystem::path& root) {
  std::error_code failed(makeFolder(root, Rights::kPrivate), std::generic_category());
  const std::string stem = fmt::format("{:%Y-%m-%dT%H%M%S}-{}", fmt::gmtime(std::time(nullptr)), getpid());
  for (int n = 0; n < 1000 && !failed; ++n) {
    folder_ = root / (n == 0 ? stem : fmt::format("{}-{}", stem, n));
    if (mkdir(folder_.c_str(), 0700) == 0) break;
    if (errno != EEXIST) failed.assign(errno, std::generic_category());
  }
  if (!failed) lock_ = takeLock(folder_ / kLock, O_CREAT);
  if (failed || lock_ < 0) {
    throw Error(Error::Code::kIo, root.string(),
                fmt::format("no folder for the journal can be made there ({})",
                            failed ? failed.message() : "its lock is refused"),
                "make room or give yourself permission there, or set XDG_STATE_HOME to another folder");
  }
}

SessionFolder::~SessionFolder() {
  removeEmpty(folder_);
  if (lock_ >= 0) close(lock_);
}

std::vector<LeftSession> leftSessions(const std::filesystem::path& root) {
  std::vector<LeftSession> left;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(root, ignored)) {
    // A folder that was removed and made again by its journal has no lock; but who writes a journal has that one's.
    const bool has_lock = std::filesystem::exists(entry.path() / kLock, ignored);
    const int lock = takeLock(has_lock ? entry.path() / kLock : journalFile(entry.path()), 0);
    if (lock < 0) continue;
    try {
      const Journal journal = readJournal(entry.path());
      const std::size_t edits = (journal.base ? journal.base->mark.edits : 0) + lastingEdits(journal).size();
      if (edits > 0 || journal.damage) {
        left.push_back(
            {entry.path(), journal.header.volume.source, edits, journal.damage ? describeDamage(*journal.damage) : ""});
      }
    } catch (const Error&) {  // nothing that could be recovered
    }
    close(lock);
  }
  std::sort(left.begin(), left.end(), [](const auto& a, const auto& b) { return a.folder > b.folder; });
  return left;
}

void passLeftSession(const LeftSession& session) {
  if (session.damage.empty()) return dropLeftSession(session);
  try {
    static_cast<void>(putAside(session.folder, session.folder));
  } catch (const Error&) {
  }
}

void dropLeftSession(const LeftSession& session) {
  std::error_code ignored;
  std::filesystem::remove(journalFile(session.folder), ignored);
  removeEmpty(session.folder);
}

}  // namespace palpate
