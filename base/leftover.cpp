// SPDX-License-Identifier: Apache-2.0
#include "base/leftover.hpp"

#include <csignal>
#include <list>
#include <mutex>
#include <utility>

#include <unistd.h>

namespace palpate {
namespace {

namespace fs = std::filesystem;

enum class LeftoverKind { kFile, kFolder, kEmptyFolder, kProcess };

struct Entry {
  std::uint64_t number = 0;
  LeftoverKind kind = LeftoverKind::kFile;
  fs::path name;  // absolute: the process may change its working folder
  pid_t child = 0;
};

struct Register {
  std::mutex mutex;
  std::list<Entry> entries;  // in the order in which they were made
  std::uint64_t last = 0;
};

// Never destroyed: static objects that own a Leftover may still release it while the process ends.
Register& globalRegister() {
  static auto* const all = new Register;
  return *all;
}

void end(const Entry& entry) {
  std::error_code ignored;
  switch (entry.kind) {
    case LeftoverKind::kFile:
      unlink(entry.name.c_str());
      return;
    case LeftoverKind::kFolder:
      fs::remove_all(entry.name, ignored);
      return;
    case LeftoverKind::kEmptyFolder:
      rmdir(entry.name.c_str());
      return;
    case LeftoverKind::kProcess:
      kill(entry.child, SIGKILL);
      return;
  }
}

// The number of the new entry; 0: nothing was made.
template <typename Make>
std::uint64_t add(LeftoverKind kind, const Make& make) {
  std::list<Entry> entry(1);  // allocated first, so that registering cannot fail once the thing exists
  entry.front().kind = kind;
  Register& all = globalRegister();
  const std::lock_guard lock(all.mutex);
  if (!make(entry.front())) return 0;
  entry.front().number = ++all.last;
  all.entries.splice(all.entries.end(), entry);
  return all.last;
}

std::uint64_t addNamed(LeftoverKind kind, const Leftover::MakeNamed& make) {
  std::error_code ignored;
  const fs::path here = fs::current_path(ignored);
  return add(kind, [&](Entry& entry) {
    entry.name = make();
    if (entry.name.empty()) return false;
    try {
      entry.name = here / entry.name;  // an absolute name stays as it is
    } catch (...) {
      end(entry);
      throw;
    }
    return true;
  });
}

}  // namespace

Leftover Leftover::file(const MakeNamed& make) {
  return Leftover(addNamed(LeftoverKind::kFile, make));
}
Leftover Leftover::folder(const MakeNamed& make) {
  return Leftover(addNamed(LeftoverKind::kFolder, make));
}
Leftover Leftover::emptyFolder(const fs::path& name) {
  return Leftover(addNamed(LeftoverKind::kEmptyFolder, [&] { return name; }));
}
Leftover Leftover::process(const std::function<pid_t()>& make) {
  return Leftover(add(LeftoverKind::kProcess, [&](Entry& entry) { return (entry.child = make()) > 0; }));
}

Leftover::Leftover(Leftover&& other) noexcept : number_(std::exchange(other.number_, 0)) {}

Leftover& Leftover::operator=(Leftover&& other) noexcept {
  if (this != &other) {
    release();
    number_ = std::exchange(other.number_, 0);
  }
  return *this;
}

void Leftover::release() noexcept {
  if (number_ == 0) return;
  Register& all = globalRegister();
  const std::lock_guard lock(all.mutex);
  all.entries.remove_if([&](const Entry& entry) { return entry.number == number_; });
  number_ = 0;
}

void endLeftovers() noexcept {
  Register& all = globalRegister();
  all.mutex.lock();  // and never unlocked
  for (auto entry = all.entries.rbegin(); entry != all.entries.rend(); ++entry) {
    try {
      end(*entry);
    } catch (...) {  // no memory: the next run removes it
    }
  }
}

}  // namespace palpate
