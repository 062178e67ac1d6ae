// SPDX-License-Identifier: Apache-2.0
// base/file_lock.hpp: whether somebody still works on a file or folder, told by its lock (flock), which ends with the
// process that holds it. Any thread. Cost: some system calls.
#pragma once

#include <cerrno>
#include <filesystem>

#include <sys/file.h>
#include <sys/stat.h>

namespace palpate {

// Whether `name` is still that of the open file or folder.
[[nodiscard]] inline bool isNameOf(const std::filesystem::path& name, int descriptor) noexcept {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(name.c_str(), &named) == 0 && named.st_dev == opened.st_dev &&
         named.st_ino == opened.st_ino;
}

// Of what others left: nobody holds its lock, which is ours now, and it still has its name, which a writer may have
// given to something else while this was opened.
[[nodiscard]] inline bool isAbandoned(const std::filesystem::path& name, int descriptor) noexcept {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 && isNameOf(name, descriptor);
}

// Of what was just made: it is this process's alone. Another one may have come between its making and its lock: then it
// holds the lock, or has removed it. Where there are no locks nobody removes anything.
[[nodiscard]] inline bool isOurs(const std::filesystem::path& name, int descriptor) noexcept {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  return isNameOf(name, descriptor);
}

}  // namespace palpate
