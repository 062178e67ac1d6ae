// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/file_fence.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/descriptor.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// What the headers of older systems lack.
constexpr std::uint64_t kTruncate = std::uint64_t{1} << 14U, kIoctlDevice = std::uint64_t{1} << 15U;
constexpr std::uint64_t kBindTcp = 1, kConnectTcp = 2;
constexpr std::uint64_t kScopeAbstractSockets = 1, kScopeSignals = 2;
constexpr int kKnowsRefer = 2, kKnowsTruncate = 3, kKnowsTcp = 4, kKnowsIoctl = 5, kKnowsScopes = 6;

constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kWrite = kRead | LANDLOCK_ACCESS_FS_WRITE_FILE;
constexpr std::uint64_t kOfFolders = LANDLOCK_ACCESS_FS_READ_DIR;  // of these, what the kernel takes for no plain file
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

// At a file, or below a folder.
bool allowAt(const Descriptor& ruleset, const std::string& path, std::uint64_t rights) {
  // A folder as such: one that is mounted when it is first used (autofs) is mounted then.
  Descriptor at(open(path.c_str(), O_PATH | O_CLOEXEC | O_DIRECTORY));
  if (!at) at = Descriptor(open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat facts {};
  if (!at || fstat(at.get(), &facts) != 0) return false;
  if (!S_ISDIR(facts.st_mode)) rights &= ~kOfFolders;
  landlock_path_beneath_attr rule = {.allowed_access = rights, .parent_fd = at.get()};
  return syscall(SYS_landlock_add_rule, ruleset.get(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

bool liesIn(const fs::path& what, const fs::path& folder) {
  return std::ranges::mismatch(folder, what).in1 == folder.end();
}

// Whether a rule for what `entry` leads to would be one for something in `hidden` too: a link or a second mount.
bool leadsTo(const fs::path& hidden, const fs::path& entry) {
  std::error_code unknown;
  const fs::path real = fs::canonical(entry, unknown), real_hidden = fs::canonical(hidden, unknown);
  return liesIn(real, real_hidden) || liesIn(real_hidden, real) || fs::equivalent(real, real_hidden, unknown) ||
         fs::equivalent(real, real_hidden.parent_path(), unknown);
}

// A rule holds for all that is below, so to leave one folder out is to name all the others. What cannot be opened, as a
// link that leads nowhere, is left out, too.
bool allowReadingBut(const Descriptor& ruleset, const std::string& hidden) {
  const fs::path without(hidden);
  std::error_code failure;
  int allowed = 0;
  for (fs::directory_iterator entry(without.parent_path(), failure), end; entry != end && !failure;
       entry.increment(failure))
    if (!leadsTo(without, entry->path()) && allowAt(ruleset, entry->path().string(), kRead)) ++allowed;
  if (allowed == 0) errno = failure ? failure.value() : ENOENT;
  return allowed > 0;
}

std::string reasonOfErrno() {
  if (errno == ENOSYS) return "this kernel has no Landlock: take Linux 5.13 or newer";
  if (errno == EOPNOTSUPP)
    return "Landlock is switched off in this kernel: add it to lsm= on the kernel's command line";
  return std::strerror(errno);
}

}  // namespace

int landlockVersion() noexcept {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

FileFence fenceFiles(const FencedPlaces& places) {
  FileFence fence;
  const int version = landlockVersion();
  if (version == 0) {
    fence.why_not = reasonOfErrno();
    return fence;
  }
  const std::uint64_t files = fileRights(version);
  const Ruleset all = {.files = files,
                       .tcp = version >= kKnowsTcp ? kBindTcp | kConnectTcp : 0,
                       .scopes = version >= kKnowsScopes ? kScopeSignals | kScopeAbstractSockets : 0};
  const std::size_t known_bytes = version >= kKnowsScopes ? sizeof all : version >= kKnowsTcp ? 16U : 8U;
  const Descriptor ruleset(static_cast<int>(syscall(SYS_landlock_create_ruleset, &all, known_bytes, 0)));
  bool made = ruleset && allowReadingBut(ruleset, places.hidden);
  for (const std::string& device : places.devices)
    made = made && allowAt(ruleset, device, files & (kWrite | kIoctlDevice));
  if (!places.own.empty()) made = made && allowAt(ruleset, places.own, files & (kWrite | kTruncate | kMake));
  fence.stands = made && syscall(SYS_landlock_restrict_self, ruleset.get(), 0) == 0;
  if (!fence.stands) fence.why_not = reasonOfErrno();
  fence.holds_signals = fence.stands && version >= kKnowsScopes;
  fence.holds_emptying = fence.stands && version >= kKnowsTruncate;
  return fence;
}

}  // namespace palpate
