// SPDX-License-Identifier: Apache-2.0
// base/leftover.hpp: temporary files, draft folders and child processes that must not outlive the process.  Whoever
// makes such a thing keeps a Leftover beside it, and removes the thing as usual. Some work cannot be stopped (a library
// that reads a file), so the process may have to end in the middle of it. Then endLeftovers() removes what is left. Any
// thread. Cost: a lock and a short text.
#pragma once

#include <cstdint>
#include <filesystem>

#include <sys/types.h>

namespace palpate {

class Leftover {
 public:
  Leftover() = default;  // stands for nothing
  [[nodiscard]] static Leftover file(const std::filesystem::path& name);
  [[nodiscard]] static Leftover folder(const std::filesystem::path& name);       // with all that is in it
  [[nodiscard]] static Leftover emptyFolder(const std::filesystem::path& name);  // removed only if it is empty
  [[nodiscard]] static Leftover process(pid_t child);                            // killed; nobody waits for it
  Leftover(Leftover&& other) noexcept;
  Leftover& operator=(Leftover&& other) noexcept;
  ~Leftover() { release(); }

  // Forgets it: it is gone or is to stay, as a file that was renamed or a process that ended.
  void release() noexcept;

 private:
  explicit Leftover(std::uint64_t number) : number_(number) {}
  std::uint64_t number_ = 0;  // 0: stands for nothing
};

// The last call of a process before _exit(). Removes everything that is left, the newest first. A thread that makes a
// new Leftover from then on waits for the end of the process. Throws nothing.
void endLeftovers() noexcept;

}  // namespace palpate
