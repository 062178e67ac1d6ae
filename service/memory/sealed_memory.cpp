// SPDX-License-Identifier: Apache-2.0
#include "service/memory/sealed_memory.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/other_version.hpp"

namespace palpate {
namespace {

constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

[[noreturn]] void refuseRoom(std::size_t bytes) {
  throw Error(Error::Code::kOutOfMemory, "shared memory",
              formatted("there are no {} bytes ({})", bytes, std::strerror(errno)),
              "close other programs, or raise the limits of memory and open files (ulimit -v, -n)");
}

}  // namespace

SealedMemory::SealedMemory(const char* name, std::size_t bytes, Pages pages)
    : file_(memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING)), bytes_(bytes) {
  if (!file_ || ftruncate(file_.get(), static_cast<off_t>(bytes)) != 0 || fcntl(file_.get(), F_ADD_SEALS, kSeals) != 0)
    refuseRoom(bytes);
  map(pages);
}

SealedMemory::SealedMemory(Descriptor given, std::size_t bytes, Pages pages) : file_(std::move(given)), bytes_(bytes) {
  struct stat facts {};
  const int seals = fcntl(file_.get(), F_GET_SEALS);  // -1: no memory of this kind
  const bool fixed = seals >= 0 && (seals & kSeals) == kSeals;
  if (!fixed || fstat(file_.get(), &facts) != 0 || static_cast<std::uint64_t>(facts.st_size) != bytes) {
    refuseOtherVersion("shared memory", formatted("it is none of {} bytes whose size is sealed", bytes));
  }
  map(pages);
}

void SealedMemory::map(Pages pages) {
  const int flags = MAP_SHARED | (pages == Pages::kAtOnce ? MAP_POPULATE : 0);
  void* const at = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, flags, file_.get(), 0);
  if (at == MAP_FAILED) refuseRoom(bytes_);
  data_ = static_cast<std::byte*>(at);
}

SealedMemory::~SealedMemory() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

SealedMemory::SealedMemory(SealedMemory&& other) noexcept
    : file_(std::move(other.file_)),
      data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)) {}

SealedMemory& SealedMemory::operator=(SealedMemory&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

}  // namespace palpate
