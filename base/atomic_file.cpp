// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <unistd.h>

#include "base/error.hpp"
#include "base/flush_folder.hpp"
#include "base/part_file.hpp"
#include "base/write_all.hpp"

namespace palpate {
namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;

const char* remedyFor(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "make room or write elsewhere";
    case ENOENT:
    case ENOTDIR:
      return "make the folder first or write elsewhere";
    default:
      return "check the permissions or write elsewhere";
  }
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  std::error_code ignored;
  const auto status = std::filesystem::status(target_, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error(Error::Code::kIo, target_.string(), "it is not a plain file and will not be replaced",
                "write to another name");
  }
  PartFile part = openPartFile(target_);
  if (part.descriptor < 0) fail("cannot be created", part.error);
  temporary_ = std::move(part.name);
  descriptor_ = part.descriptor;
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
  if (descriptor_ >= 0) close(descriptor_);
}

void AtomicFile::fail(const std::string& what, int error) const {
  throw Error(Error::Code::kIo, target_.string(), what + " (" + std::strerror(error) + ")", remedyFor(error));
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
  close(std::exchange(descriptor_, -1));  // not before: its lock says that the temporary file is in use
  const int error = flushFolder(target_.has_parent_path() ? target_.parent_path() : ".");
  if (error != 0) fail("its folder cannot be flushed", error);
}

void writeFileAtomically(const std::filesystem::path& target, std::string_view text) {
  AtomicFile file(target);
  file.write(text);
  file.commit();
}

}  // namespace palpate
