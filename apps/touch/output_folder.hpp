// SPDX-License-Identifier: Apache-2.0
// apps/touch/output_folder.hpp: the folder that a run writes into: all of its files or none. Set-up code, one thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/draft_folder.hpp"
#include "base/leftover.hpp"

namespace palpate {

// Folders made on the way to `path`; removed again at the end as far as they are empty.
class MadeFolders {
 public:
  explicit MadeFolders(const std::filesystem::path& path);  // makes nothing yet
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

 private:
  std::filesystem::path last_;
  std::filesystem::path first_;  // that was not there; empty: all were
  std::vector<Leftover> leftovers_;
};

// Makes the folder if it is not there and proves, before any long work, that files can be written into it. Throws
// Error(kIo). Files are written as drafts, in a hidden folder inside it, and moved into place together by publish();
// what was not published is removed, and so are folders that were made and stayed empty, and what killed runs left in
// the folder: their drafts and parts of files (base/draft_folder.hpp, base/part_file.hpp).
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  [[nodiscard]] std::filesystem::path file(const char* name) const { return path_ / name; }
  [[nodiscard]] std::filesystem::path draft(const char* name) const { return drafts_->path() / name; }

  // Moves every draft into place, that called `first` before the others; through a name that is a symbolic link into the
  // file that it points at. Throws Error(kIo), having moved none, where something that is no plain file is in the way or
  // a copy behind a link fails.
  void publish(const char* first = "");

  // publish() then removes an older result of this name, which would not belong to the run beside it.
  void leaveOut(const char* name) { left_out_.emplace_back(name); }

 private:
  struct Target {
    std::filesystem::path file, draft;
    std::unique_ptr<AtomicFile> behind_link;  // a copy of the draft; null: the name is no link
  };
  [[nodiscard]] Target targetOf(const std::filesystem::path& name) const;

  std::filesystem::path path_;
  MadeFolders made_;
  std::optional<DraftFolder> drafts_;
  std::vector<std::filesystem::path> left_out_;
};

}  // namespace palpate
