// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/file_fence.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/descriptor.hpp"

namespace palpate {
namespace {

// What the headers of older systems lack.
constexpr std::uint64_t kTruncate = std::uint64_t{1} << 14U, kIoctlDevice = std::uint64_t{1} << 15U;
constexpr std::uint64_t kBindTcp = 1, kConnectTcp = 2;
constexpr std::uint64_t kScopeSignal = 2;
constexpr int kKnowsRefer = 2, kKnowsTruncate = 3, kKnowsTcp = 4, kKnowsIoctl = 5, kKnowsSignals = 6;

constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kWrite = kRead | LANDLOCK_ACCESS_FS_WRITE_FILE;
constexpr std::uint64_t kMake = LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REMOVE_FILE;

// As the kernel's newest; an older one takes it as long as what it does not know is 0.
struct Ruleset {
  std::uint64_t files = 0, tcp = 0, scopes = 0;
};

std::uint64_t fileRights(int version) {
  std::uint64_t all = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1U) - 1;  // the thirteen of version 1
  if (version >= kKnowsRefer) all |= LANDLOCK_ACCESS_FS_REFER;
  if (version >= kKnowsTruncate) all |= kTruncate;
  if (version >= kKnowsIoctl) all |= kIoctlDevice;
  return all;
}

bool allowBelow(const Descriptor& ruleset, const std::string& folder, std::uint64_t rights) {
  const Descriptor at(open(folder.c_str(), O_PATH | O_CLOEXEC));
  landlock_path_beneath_attr rule = {.allowed_access = rights, .parent_fd = at.get()};
  return at && syscall(SYS_landlock_add_rule, ruleset.get(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

std::string reasonOfErrno() {
  if (errno == ENOSYS) return "this kernel has no Landlock";
  if (errno == EOPNOTSUPP) return "Landlock is switched off in this kernel";
  return std::strerror(errno);
}

}  // namespace

int landlockVersion() noexcept {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

FileFence fenceFiles(const std::string& devices, const std::string& own) {
  FileFence fence;
  const int version = landlockVersion();
  if (version == 0) {
    fence.why_not = reasonOfErrno();
    return fence;
  }
  const std::uint64_t files = fileRights(version);
  const Ruleset all = {.files = files,
                       .tcp = version >= kKnowsTcp ? kBindTcp | kConnectTcp : 0,
                       .scopes = version >= kKnowsSignals ? kScopeSignal : 0};
  const std::size_t known_bytes = version >= kKnowsSignals ? sizeof all : version >= kKnowsTcp ? 16U : 8U;
  const Descriptor ruleset(static_cast<int>(syscall(SYS_landlock_create_ruleset, &all, known_bytes, 0)));
  bool made = ruleset && allowBelow(ruleset, "/", kRead);
  if (!devices.empty()) made = made && allowBelow(ruleset, devices, files & (kWrite | kIoctlDevice));
  if (!own.empty()) made = made && allowBelow(ruleset, own, files & (kWrite | kTruncate | kMake));
  fence.stands = made && syscall(SYS_landlock_restrict_self, ruleset.get(), 0) == 0;
  if (!fence.stands) fence.why_not = reasonOfErrno();
  fence.holds_signals = fence.stands && version >= kKnowsSignals;
  return fence;
}

}  // namespace palpate
