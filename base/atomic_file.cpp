// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "base/durable_io.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = std::size_t{64} * 1024;

std::atomic<std::uint64_t> files_written = 0;

const char* remedyFor(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "make room or write elsewhere";
    case ELOOP:
      return "mend the links or write to another name";
    case ENOENT:
    case ENOTDIR:
      return "make the folder first or write elsewhere";
    default:
      return "check the permissions or write elsewhere";
  }
}

// The file that a name stands for behind symbolic links, whether it is there or not.
fs::path throughLinks(fs::path name) {
  constexpr int kMostLinks = 40;  // Linux's own limit
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(name, error)); ++i) {
    const fs::path meant = fs::read_symlink(name, error);
    if (error) break;
    name = name.parent_path() / meant;  // an absolute link replaces the folder
  }
  return name;
}

// Before the first byte. Where the old file's group may not be given, what it allowed the group is not allowed to
// another one.
void keepRightsOf(const fs::path& replaced, int descriptor) {
  struct stat old {
  }, made{};
  if (stat(replaced.c_str(), &old) != 0 || fstat(descriptor, &made) != 0) return;
  const bool same_group = old.st_gid == made.st_gid || fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) == 0;
  static_cast<void>(fchmod(descriptor, old.st_mode & (same_group ? 0777U : 0707U)));
}

// A stream of a process, as /dev/stdout: it leads to a file that others write to.
bool isStream(const fs::path& name) {
  const std::string text = name.string();
  const bool of_process = text.starts_with("/proc/") && text.find("/fd/") != std::string::npos;
  return of_process || text.starts_with("/dev/fd/") || text == "/dev/stdout" || text == "/dev/stderr";
}

}  // namespace

AtomicFile::AtomicFile(fs::path target, Rights rights) : name_(std::move(target)) {
  std::error_code error;
  const auto status = fs::status(name_, error);
  if (error.value() == ELOOP) fail("its symbolic links go round in a circle", ELOOP);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(Error::Code::kIo, name_.string(), "it is not a plain file and will not be replaced",
                "write to another name");
  }
  if (isStream(name_)) {
    throw Error(Error::Code::kIo, name_.string(), "it is a program's stream, whose file will not be replaced",
                "write to a file, and print that");
  }
  target_ = throughLinks(name_);
  PartFile part = openPartFile(target_, rights);
  if (part.descriptor < 0) fail("cannot be created", part.error);
  temporary_ = std::move(part.name);
  descriptor_ = part.descriptor;
  keepRightsOf(target_, descriptor_);
  leftover_ = std::move(part.leftover);
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
  if (descriptor_ >= 0) close(descriptor_);
}

void AtomicFile::fail(const std::string& what, int error) const {
  throw Error(Error::Code::kIo, name_.string(), what + " (" + std::strerror(error) + ")", remedyFor(error));
}

void AtomicFile::drain() {
  if (const int error = writeAll(descriptor_, buffer_); error != 0) fail("cannot be written", error);
  buffer_.clear();
}

void AtomicFile::write(std::string_view text) {
  buffer_ += text;
  if (buffer_.size() >= kBufferBytes) drain();
}

void AtomicFile::commit() {
  drain();
  if (fsync(descriptor_) != 0) fail("cannot be written", errno);
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be renamed into place", errno);
  temporary_.clear();
  ++files_written;
  leftover_.release();
  close(std::exchange(descriptor_, -1));  // not before the rename: its lock says that the temporary file is in use
  const int error = flushFolder(target_.has_parent_path() ? target_.parent_path() : ".");
  if (error != 0) fail("its folder cannot be flushed", error);
}

void checkWritable(const fs::path& target) {
  static_cast<void>(AtomicFile(target));
}

std::uint64_t filesWritten() noexcept {
  return files_written;
}

bool sameFile(const fs::path& a, const fs::path& b) {
  std::error_code ignored;  // a name that cannot be followed fails later, when it is written, with a better message
  if (fs::equivalent(a, b, ignored)) return true;
  const auto place = [&](const fs::path& name) {
    return fs::weakly_canonical(fs::absolute(throughLinks(name)), ignored);
  };
  return place(a) == place(b);
}

void checkOutputsDiffer(std::initializer_list<fs::path> outputs) {
  for (auto a = outputs.begin(); a != outputs.end(); ++a) {
    for (auto b = outputs.begin(); b != a; ++b) {
      if (a->empty() || b->empty() || !sameFile(*a, *b)) continue;
      throw Error(Error::Code::kBadInput, a->string(), "it is named for two of the outputs, and the last would be all",
                  "give each a file of its own");
    }
  }
}

void writeFileAtomically(const fs::path& target, std::string_view text, Rights rights) {
  AtomicFile file(target, rights);
  file.write(text);
  file.commit();
}

}  // namespace palpate
