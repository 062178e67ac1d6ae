// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/write_rights.hpp"

#include <cstdint>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/descriptor.hpp"

namespace palpate {
namespace {

// Those of the first version, which every kernel with Landlock knows.
constexpr std::uint64_t kHandled =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
    LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR |
    LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
    LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

constexpr std::uint64_t kWrite = LANDLOCK_ACCESS_FS_WRITE_FILE;
constexpr std::uint64_t kKeep = kWrite | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REMOVE_FILE;

bool allow(const Descriptor& rules, const std::filesystem::path& folder, std::uint64_t access) noexcept {
  const Descriptor place(open(folder.c_str(), O_PATH | O_CLOEXEC));
  if (!place) return true;  // there is nothing that could be written
  const landlock_path_beneath_attr rule{.allowed_access = access, .parent_fd = place.get()};
  return syscall(SYS_landlock_add_rule, rules.get(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

}  // namespace

bool giveUpWriting(std::span<const std::filesystem::path> written,
                   std::span<const std::filesystem::path> kept) noexcept {
  const landlock_ruleset_attr attributes{.handled_access_fs = kHandled};
  const Descriptor rules(static_cast<int>(syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0)));
  if (!rules) return false;
  for (const std::filesystem::path& folder : written)
    if (!allow(rules, folder, kWrite)) return false;
  for (const std::filesystem::path& folder : kept)
    if (!allow(rules, folder, kKeep)) return false;
  return syscall(SYS_landlock_restrict_self, rules.get(), 0) == 0;
}

}  // namespace palpate
