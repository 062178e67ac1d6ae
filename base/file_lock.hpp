// SPDX-License-Identifier: Apache-2.0
// base/file_lock.hpp: does another process still work on this file or folder? Its lock (flock) tells.
//
// The lock ends with the process that holds it. Any thread. Cost: some system calls.
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

// For a file or folder that another process made: true if nobody holds its lock and it still has its name. (A writer
// may have given the name to another file while this one was opened.) If true, this process holds the lock now.
[[nodiscard]] inline bool isAbandoned(const std::filesystem::path& name, int descriptor) noexcept {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 && isNameOf(name, descriptor);
}

// For a file or folder that this process has just made: locks it, and is true if it still belongs to this process
// alone. Another process may have locked or removed it before the lock was taken. On a file system without locks this
// is true, since nobody removes anything there. It is true, too, in a process that may not lock (service/sandbox):
// there another writer of the same file may remove this one's temporary file, and then its commit fails and says so.
[[nodiscard]] inline bool isOurs(const std::filesystem::path& name, int descriptor) noexcept {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  return isNameOf(name, descriptor);
}

}  // namespace palpate
