// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/session_folders.hpp: a folder for the journal of each session, and those that a crash has left.
//
// A session holds a lock on a file in its folder, which the system takes away when the program ends, however it ends.
// One thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

class SessionFolder {
 public:
  // Makes a new folder below `root`, and `root` itself. Throws Error(kIo).
  explicit SessionFolder(const std::filesystem::path& root);
  ~SessionFolder();  // removes the folder if it holds nothing but the lock
  SessionFolder(const SessionFolder&) = delete;
  SessionFolder& operator=(const SessionFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return folder_; }

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
};

// A session that was not closed, with work that was not saved.
struct LeftSession {
  std::filesystem::path folder;
  std::string volume;     // as loadVolume takes it
  std::size_t edits = 0;  // that are in effect
  std::string damage;     // what of its journal cannot be read; empty: nothing
};

// Of all folders below `root` that no program holds, the newest first. Folders without a journal, or with a sound one
// without edits, are left out, as is a journal whose header cannot be read.
[[nodiscard]] std::vector<LeftSession> leftSessions(const std::filesystem::path& root);

// Deletes the journal of a session that is not wanted any more, and its folder.
void dropLeftSession(const LeftSession& session);
// The edits are in another journal: the same, but a journal that was not read to its end is kept, under another name.
// Where that cannot be, it stays, and is offered again.
void passLeftSession(const LeftSession& session);

}  // namespace palpate
