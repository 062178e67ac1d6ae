// SPDX-License-Identifier: Apache-2.0
// apps/touch/output_folder.hpp: the folder that a run writes into. The run leaves all of its files there or none, and
// replaces no file that is not an earlier run's. Set-up code, one thread.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/draft_folder.hpp"
#include "base/leftover.hpp"

namespace palpate {

inline constexpr std::array<const char*, 4> kRunResults = {"trace.csv", "summary.json", "report.html", "view.png"};

// The files in the folder that have a name of kRunResults but are no run's result: no summary.json of a run lists them.
// A run's summary counts as its own result. Only plain files are looked at; OutputFolder::publish() refuses all else.
[[nodiscard]] std::vector<std::string> foreignResults(const std::filesystem::path& folder);

// Throws Error(kBadInput) if there is such a file, so that a run never replaces what another program wrote.
void refuseForeignResults(const std::filesystem::path& folder);

// The folders that a run makes on the way to `path`. The destructor removes those that are empty.
class MadeFolders {
 public:
  explicit MadeFolders(const std::filesystem::path& path);  // makes no folder yet
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

 private:
  std::filesystem::path last_;
  std::filesystem::path first_;  // the outermost folder that was missing; empty: none was
  std::vector<Leftover> leftovers_;
};

// Makes the folder if it is not there, and checks that files can be written into it before any long work begins. Throws
// Error(kIo).
//
// Files are written as drafts in a hidden folder inside it; publish() moves them into place together. The destructor
// removes drafts that were not published, and folders that were made and stayed empty. What killed runs left in the
// folder (drafts and part files: base/draft_folder.hpp, base/part_file.hpp) is removed too.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  [[nodiscard]] std::filesystem::path file(const char* name) const { return path_ / name; }
  [[nodiscard]] std::filesystem::path draft(const char* name) const { return drafts_->path() / name; }

  // Calls work(draft of `name`), which writes it. An error that names the draft, which nobody knows, comes out with the
  // file's name.
  void write(const char* name, const std::function<void(const std::filesystem::path&)>& work) const;

  // Moves every draft into place, the one called `first` before the others. Where the name is a symbolic link, the file
  // that it points at is replaced. Throws Error(kIo), with nothing moved, if something other than a plain file is in
  // the way or if copying a draft behind a link fails.
  void publish(const char* first = "");

  // Makes publish() remove an older result of this name, which would not belong to this run.
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
