// SPDX-License-Identifier: Apache-2.0
// base/file_lock.hpp: tells by its lock (flock) whether a process still works on a file or folder. The lock ends with
// the process that holds it. Any thread. Cost: some system calls.
#pragma once

#include <cerrno>
#include <filesystem>

#include <sys/file.h>
#include <sys/stat.h>

namespace palpate {

// Whether `name` is still the name of the open file or folder.
[[nodiscard]] inline bool isNameOf(const std::filesystem::path& name, int descriptor) noexcept {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(name.c_str(), &named) == 0 && named.st_dev == opened.st_dev &&
         named.st_ino == opened.st_ino;
}

// For a file or folder that others left: true if nobody holds its lock and it still has its name. (A writer may have
// given the name to something else while this was opened.) If true, this process holds the lock now.
[[nodiscard]] inline bool isAbandoned(const std::filesystem::path& name, int descriptor) noexcept {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 && isNameOf(name, descriptor);
}

// For a file or folder that this process has just made: true if it is still this process's alone. Between the making
// and the lock another process may have locked or removed it. On a file system without locks this is true, since nobody
// removes anything there.
[[nodiscard]] inline bool isOurs(const std::filesystem::path& name, int descriptor) noexcept {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  return isNameOf(name, descriptor);
}

}  // namespace palpate
