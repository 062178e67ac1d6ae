// SPDX-License-Identifier: Apache-2.0
// A folder whose machine may lose its power at any moment: what no fsync has brought to the disk is lost, in part, and
// in any order.
//
// While one lives, this program's calls of fsync, fdatasync, rename, link and unlink go through it (unsynced_disk.cpp
// stands before the C library). It knows what the disk surely has: a file's bytes since its last sync, a folder's
// entries since the folder's. All else may be there or not: each sector of a file, its length, each entry. A rename
// alone is atomic. Before and after each such call the power may be cut; what the disk then holds is an image. Bytes
// that were synced and not written again stay as they are.
// Sources: T. S. Pillai et al., "All File Systems Are Not Created Equal", OSDI 2014; "How SQLite Is Tested", Crash
// Testing. One at a time in a process. Any thread may make the calls.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace palpate {

class UnsyncedDisk {
 public:
  struct Image {
    std::string moment;                        // "before fsync of journal/checkpoint-0.palpate"
    std::map<std::string, std::string> files;  // by their names below the folder
    std::vector<std::string> folders;          // outermost first
    void write(const std::filesystem::path& folder) const;
  };
  // `folder`, and all that is in it now, is on the disk. At one in `every` moments the power is cut, or at a quarter of
  // these where a file is synced that was so before. Then `cut` gets what the disk holds, in the thread whose call it
  // is. It must not make such calls in that folder.
  UnsyncedDisk(std::filesystem::path folder, unsigned seed, int every, std::function<void(Image)> cut);
  ~UnsyncedDisk();
  UnsyncedDisk(const UnsyncedDisk&) = delete;
  UnsyncedDisk& operator=(const UnsyncedDisk&) = delete;

  // For the calls alone. `change` does the real thing.
  int sync(int descriptor);
  int rename(const std::string& from, const std::string& to, const std::function<int()>& change);
  int change(const char* what, const std::string& name, const std::function<int()>& change);

 private:
  // An inode, also where its number is used again.
  using Key = std::pair<std::uint64_t, std::int64_t>;
  using Entries = std::map<std::string, Key>;               // by their names below the folder
  using Change = std::vector<std::pair<std::string, Key>>;  // of entries, all at once; kGone: none any more
  static constexpr Key kGone{};

  [[nodiscard]] static Key keyOf(int folder, const std::string& name, int flags, bool& is_folder);
  [[nodiscard]] Entries look();
  void takeIn();
  void apply(const Change& change, Entries& entries) const;
  void moment(const std::string& words, int often = 1);
  [[nodiscard]] Image imageNow(const std::string& words);
  [[nodiscard]] std::string contentNow(Key key, int mode);
  [[nodiscard]] std::string nameOf(const std::string& path) const;

  const std::filesystem::path folder_;
  std::mt19937 random_;
  const int every_;
  const std::function<void(Image)> cut_;
  Entries seen_, durable_;
  std::vector<Change> pending_;  // from durable_ to seen_, in order
  std::map<Key, bool> is_folder_;
  std::map<Key, std::string> synced_;  // bytes
};

}  // namespace palpate
