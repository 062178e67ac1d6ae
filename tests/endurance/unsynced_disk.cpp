// SPDX-License-Identifier: Apache-2.0
#include "unsynced_disk.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::recursive_mutex lock_of_all;
UnsyncedDisk* disk = nullptr;

std::string bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

UnsyncedDisk::UnsyncedDisk(fs::path folder, unsigned seed, int every, std::function<void(Image)> cut)
    : folder_(std::move(folder)), random_(seed), every_(every), cut_(std::move(cut)) {
  const std::lock_guard lock(lock_of_all);
  if (disk != nullptr) throw std::logic_error("there is such a disk already");
  disk = this;
  durable_ = seen_ = look();
  for (const auto& [name, key] : durable_)
    if (!is_folder_.at(key)) synced_[key] = bytesOf(folder_ / name);
}

UnsyncedDisk::~UnsyncedDisk() {
  const std::lock_guard lock(lock_of_all);
  disk = nullptr;
}

UnsyncedDisk::Key UnsyncedDisk::keyOf(int folder, const std::string& name, int flags, bool& is_folder) {
  struct statx facts {};
  if (statx(folder, name.c_str(), AT_SYMLINK_NOFOLLOW | flags, STATX_INO | STATX_BTIME | STATX_TYPE, &facts) != 0)
    return kGone;
  is_folder = S_ISDIR(facts.stx_mode);
  return {facts.stx_ino, facts.stx_btime.tv_sec * 1'000'000'000 + facts.stx_btime.tv_nsec};
}

// Others add and remove entries meanwhile.
UnsyncedDisk::Entries UnsyncedDisk::look() {
  Entries entries;
  std::error_code ignored;
  for (fs::recursive_directory_iterator at(folder_, ignored), end; at != end; at.increment(ignored)) {
    bool is_folder = false;
    const Key key = keyOf(AT_FDCWD, at->path().string(), 0, is_folder);
    if (key == kGone) continue;
    is_folder_[key] = is_folder;
    entries[at->path().lexically_relative(folder_).string()] = key;
  }
  return entries;
}

// Each entry that was made, replaced or removed since the last look, as a change of its own.
void UnsyncedDisk::takeIn() {
  Entries now = look();
  for (const auto& [name, key] : seen_)
    if (!now.contains(name)) pending_.push_back({{name, kGone}});
  for (const auto& [name, key] : now) {
    const auto before = seen_.find(name);
    if (before == seen_.end() || before->second != key) pending_.push_back({{name, key}});
  }
  seen_ = std::move(now);
}

// With a folder goes what was in it, also where another gets its name.
void UnsyncedDisk::apply(const Change& change, Entries& entries) const {
  for (const auto& [name, key] : change) {
    const auto old = entries.find(name);
    if (old != entries.end() && old->second != key && is_folder_.at(old->second))
      std::erase_if(entries, [&](const auto& entry) { return entry.first.starts_with(name + "/"); });
    entries.erase(name);
    if (key != kGone) entries[name] = key;
  }
}

int UnsyncedDisk::sync(int descriptor) {
  bool is_folder = false;
  const Key key = keyOf(descriptor, "", AT_EMPTY_PATH, is_folder);
  const std::string self = "/proc/self/fd/" + std::to_string(descriptor);
  std::error_code ignored;
  const fs::path path = fs::read_symlink(self, ignored);
  const std::string name = nameOf(path.string());
  if (name.empty()) return 0;
  // A file that is appended to is synced far more often than all else is done.
  const int often = synced_.contains(key) ? 4 : 1;
  moment("before a sync of " + name, often);
  takeIn();
  if (is_folder) {
    const std::string parent = name == "." ? "" : name;
    std::vector<Change> left;
    for (Change& change : pending_) {
      const bool is_here = std::ranges::any_of(
          change, [&](const auto& entry) { return fs::path(entry.first).parent_path().string() == parent; });
      if (!is_here) {
        left.push_back(std::move(change));
        continue;
      }
      apply(change, durable_);
    }
    pending_ = std::move(left);
  } else {
    synced_[key] = bytesOf(self);
  }
  moment("after a sync of " + name, often);
  return 0;
}

int UnsyncedDisk::rename(const std::string& from, const std::string& to, const std::function<int()>& change) {
  const std::string old_name = nameOf(from), new_name = nameOf(to);
  if (old_name.empty() || new_name.empty()) return change();
  moment("before a rename to " + new_name);
  takeIn();
  const int result = change();
  Entries now = look();
  if (result == 0 && now.contains(new_name)) {
    pending_.push_back({{old_name, kGone}, {new_name, now.at(new_name)}});
    seen_.erase(old_name);
    seen_[new_name] = now.at(new_name);
  }
  moment("after a rename to " + new_name);
  return result;
}

int UnsyncedDisk::change(const char* what, const std::string& name, const std::function<int()>& change) {
  const std::string known = nameOf(name);
  if (known.empty()) return change();
  moment(std::string("before ") + what + " of " + known);
  takeIn();
  const int result = change();
  moment(std::string("after ") + what + " of " + known);
  return result;
}

// Below the folder; ".": the folder itself; "": elsewhere.
std::string UnsyncedDisk::nameOf(const std::string& path) const {
  const std::string name = fs::absolute(path).lexically_normal().lexically_relative(folder_).string();
  return name.starts_with("..") ? "" : name;
}

void UnsyncedDisk::moment(const std::string& words, int often) {
  if (std::uniform_int_distribution(1, every_ * often)(random_) == 1) cut_(imageNow(words));
}

UnsyncedDisk::Image UnsyncedDisk::imageNow(const std::string& words) {
  takeIn();
  // All that was not synced is lost, or nothing is, or some.
  const int mode = std::uniform_int_distribution(0, 3)(random_);
  Entries entries = durable_;
  for (const Change& change : pending_) {
    if (mode == 0 || (mode > 1 && std::bernoulli_distribution(0.5)(random_))) continue;
    apply(change, entries);
  }
  Image image{.moment = words, .files = {}, .folders = {}};
  for (const auto& [name, key] : entries) {  // a folder comes before what is in it
    const std::string parent = fs::path(name).parent_path().string();
    if (!parent.empty() && std::ranges::find(image.folders, parent) == image.folders.end()) continue;
    if (is_folder_.at(key)) {
      image.folders.push_back(name);
    } else {
      image.files[name] = contentNow(key, mode);
    }
  }
  return image;
}

// Mode 3: what was written may have given the file its length and not its bytes.
std::string UnsyncedDisk::contentNow(Key key, int mode) {
  const auto synced = synced_.find(key);
  const std::string before = synced == synced_.end() ? "" : synced->second;
  const auto named = std::ranges::find_if(seen_, [&](const auto& entry) { return entry.second == key; });
  if (mode == 0 || named == seen_.end()) return before;
  const std::string now = bytesOf(folder_ / named->first);
  if (mode == 1) return now;
  constexpr std::size_t kSector = 512;
  const auto [shorter, longer] = std::minmax(before.size(), now.size());
  std::string mixed(std::uniform_int_distribution(shorter, longer)(random_), '\0');
  for (std::size_t at = 0; at < mixed.size(); at += kSector) {
    const std::string& from = std::bernoulli_distribution(0.5)(random_) ? now : before;
    const std::size_t count = std::min(kSector, mixed.size() - at);
    if (at < from.size()) from.copy(mixed.data() + at, count, at);
    if (mode == 3 && &from == &before) {  // bytes of something else where there were none
      for (std::size_t i = std::max(at, before.size()); i < at + count; ++i) mixed[i] = static_cast<char>(random_());
    }
  }
  return mixed;
}

void UnsyncedDisk::Image::write(const fs::path& folder) const {
  fs::create_directories(folder);
  for (const std::string& name : folders) fs::create_directory(folder / name);
  for (const auto& [name, bytes] : files) std::ofstream(folder / name, std::ios::binary) << bytes;
}

}  // namespace palpate

// These stand before the C library's, for this program and the libraries that it loads.
extern "C" {

int fsync(int descriptor) {
  const std::lock_guard lock(palpate::lock_of_all);
  return palpate::disk != nullptr ? palpate::disk->sync(descriptor) : static_cast<int>(syscall(SYS_fsync, descriptor));
}

int fdatasync(int descriptor) {
  const std::lock_guard lock(palpate::lock_of_all);
  return palpate::disk != nullptr ? palpate::disk->sync(descriptor)
                                  : static_cast<int>(syscall(SYS_fdatasync, descriptor));
}

int rename(const char* from, const char* to) noexcept {
  const std::lock_guard lock(palpate::lock_of_all);
  const auto change = [&] { return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0)); };
  return palpate::disk != nullptr ? palpate::disk->rename(from, to, change) : change();
}

int link(const char* from, const char* to) noexcept {
  const std::lock_guard lock(palpate::lock_of_all);
  const auto change = [&] { return static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0)); };
  return palpate::disk != nullptr ? palpate::disk->change("a link", to, change) : change();
}

int unlink(const char* name) noexcept {
  const std::lock_guard lock(palpate::lock_of_all);
  const auto change = [&] { return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, name, 0)); };
  return palpate::disk != nullptr ? palpate::disk->change("a removal", name, change) : change();
}
}
