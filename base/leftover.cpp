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

enum class Kind { kFile, kFolder, kEmptyFolder, kProcess };

struct Entry {
  std::uint64_t number;
  Kind kind;
  fs::path name;  // absolute: the process may go to another folder
  pid_t child;
};

struct Register {
  std::mutex mutex;
  std::list<Entry> entries;  // in the order in which they were made
  std::uint64_t last = 0;
};

// Never destroyed: what lives to the process's end tidies up then.
Register& theRegister() {
  static auto* const all = new Register;
  return *all;
}

std::uint64_t add(Kind kind, const fs::path& name, pid_t child) {
  std::error_code ignored;
  Entry entry{0, kind, name.empty() ? name : fs::absolute(name, ignored), child};
  Register& all = theRegister();
  const std::lock_guard lock(all.mutex);
  entry.number = ++all.last;
  all.entries.push_back(std::move(entry));
  return all.last;
}

void end(const Entry& entry) {
  std::error_code ignored;
  switch (entry.kind) {
    case Kind::kFile:
      unlink(entry.name.c_str());
      return;
    case Kind::kFolder:
      fs::remove_all(entry.name, ignored);
      return;
    case Kind::kEmptyFolder:
      rmdir(entry.name.c_str());
      return;
    case Kind::kProcess:
      kill(entry.child, SIGKILL);
      return;
  }
}

}  // namespace

Leftover Leftover::file(const fs::path& name) {
  return Leftover(add(Kind::kFile, name, 0));
}
Leftover Leftover::folder(const fs::path& name) {
  return Leftover(add(Kind::kFolder, name, 0));
}
Leftover Leftover::emptyFolder(const fs::path& name) {
  return Leftover(add(Kind::kEmptyFolder, name, 0));
}
Leftover Leftover::process(pid_t child) {
  return Leftover(add(Kind::kProcess, {}, child));
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
  Register& all = theRegister();
  const std::lock_guard lock(all.mutex);
  all.entries.remove_if([&](const Entry& entry) { return entry.number == number_; });
  number_ = 0;
}

void endLeftovers() noexcept {
  Register& all = theRegister();
  all.mutex.lock();  // and never unlocked
  for (auto entry = all.entries.rbegin(); entry != all.entries.rend(); ++entry) {
    try {
      end(*entry);
    } catch (...) {  // no memory: the next run sweeps it
    }
  }
}

}  // namespace palpate
