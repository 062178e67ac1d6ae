// SPDX-License-Identifier: Apache-2.0
// base/leftover.hpp: removes temporary files, draft folders and child processes that must not outlive this process.
//
// Whoever makes such a thing makes it through a Leftover and keeps the Leftover beside it. The owner removes the thing
// as usual. But some work cannot be stopped, such as a library that reads a file. Then the process may have to end in
// the middle of it, and endLeftovers() removes what is left.
// A thing is made under the lock that endLeftovers() takes and never releases. So by then it is either registered, or
// it is never made.
// Any thread. Cost: a lock and a short text.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include <sys/types.h>

namespace palpate {

class Leftover {
 public:
  Leftover() = default;  // stands for nothing
  // `make` makes the thing and returns its name. An empty name or an exception says that it made nothing. It may not
  // make another Leftover, and it may not take long.
  using MakeNamed = std::function<std::filesystem::path()>;
  [[nodiscard]] static Leftover file(const MakeNamed& make);
  [[nodiscard]] static Leftover folder(const MakeNamed& make);  // removed with all that is in it
  // `make` starts a process and returns its id; 0 or less: it started none. The process is killed, and nobody waits for
  // it.
  [[nodiscard]] static Leftover process(const std::function<pid_t()>& make);
  // A folder that may be made later. Removed only if it is there and empty.
  [[nodiscard]] static Leftover emptyFolder(const std::filesystem::path& name);
  Leftover(Leftover&& other) noexcept;
  Leftover& operator=(Leftover&& other) noexcept;
  ~Leftover() { release(); }

  [[nodiscard]] explicit operator bool() const noexcept { return number_ != 0; }  // false: stands for nothing

  // Forgets the thing. It is gone or is to stay: a file that was renamed, a process that ended.
  void release() noexcept;

 private:
  explicit Leftover(std::uint64_t number) : number_(number) {}
  std::uint64_t number_ = 0;  // 0: stands for nothing
};

// The last call of a process before _exit(). Removes everything that is left, newest first. A thread that tries to make
// a Leftover afterwards blocks until the process ends. Throws nothing.
void endLeftovers() noexcept;

}  // namespace palpate
