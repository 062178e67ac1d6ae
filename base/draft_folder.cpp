// SPDX-License-Identifier: Apache-2.0
#include "base/draft_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "base/file_lock.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTail = "XXXXXX";  // as mkdtemp() has it

bool isDraft(std::string_view name, std::string_view prefix) {
  if (name.size() != prefix.size() + kTail.size() || !name.starts_with(prefix)) return false;
  name.remove_prefix(prefix.size());
  return std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
}

int openFolder(const fs::path& name) {
  return open(name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

void removeDraftIfLeft(const fs::path& name) {
  const int descriptor = openFolder(name);
  if (descriptor < 0) return;
  std::error_code ignored;
  if (isAbandoned(name, descriptor)) fs::remove_all(name, ignored);
  close(descriptor);
}

void removeLeftDrafts(const fs::path& parent, const std::string& prefix) {
  std::vector<fs::path> names;  // collected first: removing entries while the folder is read may skip or repeat others
  std::error_code error;
  for (fs::directory_iterator entry(parent, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (isDraft(entry->path().filename().native(), prefix)) names.push_back(entry->path());
  for (const fs::path& name : names) removeDraftIfLeft(name);
}

}  // namespace

DraftFolder::DraftFolder(const fs::path& parent, const std::string& prefix) {
  removeLeftDrafts(parent, prefix);
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    std::string name = (parent / (prefix + std::string(kTail))).string();
    leftover_ = Leftover::folder([&] {
      if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category());
      return fs::path(name);
    });
    lock_ = openFolder(name);
    path_ = name;
    if (lock_ < 0 || isOurs(path_, lock_))
      return;  // a folder that cannot be opened has no lock, and nobody else can open and remove it
    close(lock_);
  }
  throw std::system_error(EBUSY, std::generic_category());
}

DraftFolder::~DraftFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

}  // namespace palpate
