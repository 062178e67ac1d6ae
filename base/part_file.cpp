// SPDX-License-Identifier: Apache-2.0
#include "base/part_file.hpp"

#include <algorithm>
#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_lock.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";

// The target of "FILE.123.part", "FILE.123-4.part": "FILE"; empty: it is no such name.
std::string_view targetOf(std::string_view name) {
  if (!name.ends_with(kSuffix)) return {};
  name.remove_suffix(kSuffix.size());
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot + 1 == name.size()) return {};
  const std::string_view number = name.substr(dot + 1);
  const bool is_number =
      std::all_of(number.begin(), number.end(), [](char c) { return (c >= '0' && c <= '9') || c == '-'; });
  return is_number ? name.substr(0, dot) : std::string_view();
}

bool isPlainFile(int descriptor) {
  struct stat facts {};
  return fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
}

void removeIfLeft(const fs::path& name) {
  const int descriptor = open(name.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  if (isPlainFile(descriptor) && isAbandoned(name, descriptor)) unlink(name.c_str());
  close(descriptor);
}

}  // namespace

void sweepPartFiles(const fs::path& folder, const std::function<bool(std::string_view target)>& is_meant) {
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().native();
    const std::string_view target = targetOf(name);
    if (!target.empty() && is_meant(target)) removeIfLeft(entry->path());
  }
}

PartFile openPartFile(const fs::path& target) {
  const std::string name = target.filename();
  sweepPartFiles(target.parent_path(), [&](std::string_view of) { return of == name; });
  constexpr int kTries = 100;
  PartFile part;
  for (int i = 0; i < kTries; ++i) {
    part.name = target;
    part.name += i == 0 ? fmt::format(".{}{}", getpid(), kSuffix) : fmt::format(".{}-{}{}", getpid(), i, kSuffix);
    part.descriptor = open(part.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    part.error = part.descriptor < 0 ? errno : 0;
    if (part.error == EEXIST) continue;
    if (part.error != 0 || isOurs(part.name, part.descriptor)) return part;
    close(part.descriptor);
    part = {-1, {}, EEXIST};
  }
  return part;
}

}  // namespace palpate
