// SPDX-License-Identifier: Apache-2.0
#include "base/part_file.hpp"

#include <algorithm>
#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";

// "FILE.123.part", "FILE.123-4.part" of target "FILE".
bool isPartOf(const std::string& target, std::string_view name) {
  if (!name.starts_with(target + ".") || !name.ends_with(kSuffix)) return false;
  name.remove_prefix(target.size() + 1);
  if (name.size() <= kSuffix.size()) return false;
  name.remove_suffix(kSuffix.size());
  return std::all_of(name.begin(), name.end(), [](char c) { return (c >= '0' && c <= '9') || c == '-'; });
}

// Whether `name` is still that of the open file, a plain one.
bool isNameOf(const fs::path& name, int descriptor) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) && lstat(name.c_str(), &named) == 0 &&
         named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

// Under its lock, so its writer is gone; and only by its own name, which a writer may have given to the next file while
// this one was opened here.
void removeIfLeft(const fs::path& name) {
  const int descriptor = open(name.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && isNameOf(name, descriptor)) unlink(name.c_str());
  close(descriptor);
}

void removeLeftParts(const fs::path& target) {
  const std::string name = target.filename();
  std::error_code error;
  fs::directory_iterator entry(target.has_parent_path() ? target.parent_path() : ".", error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (isPartOf(name, entry->path().filename().native())) removeIfLeft(entry->path());
  }
}

// Whether the file is this writer's alone. Another one may have come between its making and its lock: then it holds the
// lock, or has removed the file. Where there are no locks nobody removes any.
bool isOurs(const PartFile& part) {
  if (flock(part.descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  return isNameOf(part.name, part.descriptor);
}

}  // namespace

PartFile openPartFile(const fs::path& target) {
  removeLeftParts(target);
  constexpr int kTries = 100;
  PartFile part;
  for (int i = 0; i < kTries; ++i) {
    part.name = target;
    part.name += i == 0 ? fmt::format(".{}{}", getpid(), kSuffix) : fmt::format(".{}-{}{}", getpid(), i, kSuffix);
    part.descriptor = open(part.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    part.error = part.descriptor < 0 ? errno : 0;
    if (part.error == EEXIST) continue;
    if (part.error != 0 || isOurs(part)) return part;
    close(part.descriptor);
    part = {-1, {}, EEXIST};
  }
  return part;
}

}  // namespace palpate
