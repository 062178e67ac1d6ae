// SPDX-License-Identifier: Apache-2.0
// base/leftover.hpp: temporary files, draft folders and child processes that must not outlive the process.
// Whoever makes such a thing makes it through a Leftover, keeps that beside it, and removes the thing as usual. Some
// work cannot be stopped (a library that reads a file), so the process may have to end in the middle of it. Then
// endLeftovers() removes what is left. Any thread. Cost: a lock and a short text.
// A thing is made under the lock that endLeftovers() takes for good. So it is either registered by then or never made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include <sys/types.h>

namespace palpate {

class Leftover {
 public:
  Leftover() = default;  // stands for nothing
  // `make` makes the thing and returns its name; an empty one, or an exception: it made nothing. It makes no other
  // Leftover and does not take long.
  using MakeNamed = std::function<std::filesystem::path()>;
  [[nodiscard]] static Leftover file(const MakeNamed& make);
  [[nodiscard]] static Leftover folder(const MakeNamed& make);  // removed with all that is in it
  // `make` starts a process, which is killed; nobody waits for it. 0 or less: there is none.
  [[nodiscard]] static Leftover process(const std::function<pid_t()>& make);
  // A folder that may be made later. Removed only if it is there and empty.
  [[nodiscard]] static Leftover emptyFolder(const std::filesystem::path& name);
  Leftover(Leftover&& other) noexcept;
  Leftover& operator=(Leftover&& other) noexcept;
  ~Leftover() { release(); }

  [[nodiscard]] explicit operator bool() const noexcept { return number_ != 0; }  // whether there is anything

  // Forgets it: it is gone or is to stay, as a file that was renamed or a process that ended.
  void release() noexcept;

 private:
  explicit Leftover(std::uint64_t number) : number_(number) {}
  std::uint64_t number_ = 0;  // 0: stands for nothing
};

// The last call of a process before _exit(). Removes everything that is left, the newest first. A thread that wants to
// make something from then on waits for the end of the process. Throws nothing.
void endLeftovers() noexcept;

}  // namespace palpate
