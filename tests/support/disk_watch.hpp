// SPDX-License-Identifier: Apache-2.0
// Watches what this program brings to the disk: its own fsync, fdatasync, link and rename stand in front of the C
// library's and do what those do. A crash of the machine cannot be had in a test; that nothing is named or acknowledged
// before the disk was asked for can. Include it in one source file of a test.
#pragma once

#include <cerrno>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace disk_watch {

inline std::mutex mutex;
inline std::map<ino_t, off_t> flushed;    // plain files' sizes when they were flushed last [byte]
inline std::map<std::string, int> named;  // files that got their name by link or rename: 1 if all was flushed, else 0
inline int error_of_next_flush = 0;       // 0: it succeeds

inline int flush(int descriptor, long call) {
  const std::lock_guard lock(mutex);
  if (error_of_next_flush != 0) {
    errno = std::exchange(error_of_next_flush, 0);
    return -1;
  }
  struct stat facts {};
  if (fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode)) flushed[facts.st_ino] = facts.st_size;
  return static_cast<int>(syscall(call, descriptor));
}

inline void noteName(const char* from, const char* to) {
  const std::lock_guard lock(mutex);
  struct stat facts {};
  if (lstat(from, &facts) != 0 || !S_ISREG(facts.st_mode)) return;
  const auto found = flushed.find(facts.st_ino);
  named[to] = found != flushed.end() && found->second == facts.st_size ? 1 : 0;
}

// Of a file by its name [byte]; 0: it was never flushed.
inline off_t flushedBytes(const std::string& file) {
  const std::lock_guard lock(mutex);
  struct stat facts {};
  if (stat(file.c_str(), &facts) != 0) return 0;
  const auto found = flushed.find(facts.st_ino);
  return found != flushed.end() ? found->second : 0;
}

}  // namespace disk_watch

extern "C" {
int fsync(int descriptor) {
  return disk_watch::flush(descriptor, SYS_fsync);
}
int fdatasync(int descriptor) {
  return disk_watch::flush(descriptor, SYS_fdatasync);
}
int link(const char* from, const char* to) noexcept {
  disk_watch::noteName(from, to);
  return static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int rename(const char* from, const char* to) noexcept {
  disk_watch::noteName(from, to);
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
}
