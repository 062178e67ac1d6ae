// SPDX-License-Identifier: Apache-2.0
#include "base/part_file.hpp"

#include <algorithm>
#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/crc32c.hpp"
#include "base/file_lock.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".palpate-part";  // a name that no other program gives

bool isNumber(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// "FILE" for "FILE.123.palpate-part" and "FILE.123-4.palpate-part"; empty for any other name.
std::string_view targetOf(std::string_view name) {
  if (!name.ends_with(kSuffix)) return {};
  name.remove_suffix(kSuffix.size());
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return {};
  const std::string_view number = name.substr(dot + 1);
  const std::size_t dash = number.find('-');
  const bool is_number =
      isNumber(number.substr(0, dash)) && (dash == std::string_view::npos || isNumber(number.substr(dash + 1)));
  return is_number ? name.substr(0, dot) : std::string_view();
}

// What stands for a target in the names of its part files. File systems take names of up to 255 bytes; what is added to
// it, ".PID-N.palpate-part", takes 25 at most.
std::string stemOf(const std::string& target) {
  constexpr std::size_t kLongest = 255 - 25, kKept = 200;
  if (target.size() <= kLongest) return target;
  std::size_t kept = kKept;
  while (kept > 0 && (static_cast<unsigned char>(target[kept]) & 0xC0U) == 0x80U) --kept;  // between UTF-8 characters
  return fmt::format("{}~{:08x}", target.substr(0, kept), crc32c(target));
}

bool isPlainFile(int descriptor) {
  struct stat facts {};
  return fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
}

void removePartIfLeft(const fs::path& name) {
  const int descriptor = open(name.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  if (isPlainFile(descriptor) && isAbandoned(name, descriptor)) unlink(name.c_str());
  close(descriptor);
}

template <typename IsMeant>
void sweep(const fs::path& folder, const IsMeant& is_meant) {
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().native();
    const std::string_view target = targetOf(name);
    if (!target.empty() && is_meant(target)) removePartIfLeft(entry->path());
  }
}

}  // namespace

void sweepPartFiles(const fs::path& folder) {
  sweep(folder, [](std::string_view) { return true; });
}

PartFile openPartFile(const fs::path& target, Rights rights) {
  const std::string stem = stemOf(target.filename());
  sweep(target.parent_path(), [&](std::string_view of) { return of == stem; });
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    PartFile part;
    part.name = target.parent_path() / (i == 0 ? fmt::format("{}.{}{}", stem, getpid(), kSuffix)
                                               : fmt::format("{}.{}-{}{}", stem, getpid(), i, kSuffix));
    part.leftover = Leftover::file([&] {
      part.descriptor =
          open(part.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, rights == Rights::kPrivate ? 0600 : 0666);
      part.error = part.descriptor < 0 ? errno : 0;
      return part.descriptor < 0 ? fs::path() : part.name;
    });
    if (part.error == EEXIST) continue;
    if (part.error != 0 || isOurs(part.name, part.descriptor)) return part;
    close(part.descriptor);
  }
  PartFile none;
  none.error = EEXIST;
  return none;
}

}  // namespace palpate
