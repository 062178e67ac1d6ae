// SPDX-License-Identifier: Apache-2.0
// base/leftover.hpp: what must not outlive the process although nobody may come to tidy it up: temporary files,
// folders of drafts, child processes.
//
// Whoever makes such a thing keeps a Leftover beside it and tidies up as ever. Where the process has to be ended in the
// middle of work that cannot be stopped (a library that reads a file), endLeftovers() does it instead. Any thread.
// Cost: a lock and a short text.
#pragma once

#include <cstdint>
#include <filesystem>

#include <sys/types.h>

namespace palpate {

class Leftover {
 public:
  Leftover() = default;  // of nothing
  [[nodiscard]] static Leftover file(const std::filesystem::path& name);
  [[nodiscard]] static Leftover folder(const std::filesystem::path& name);       // with all that is in it
  [[nodiscard]] static Leftover emptyFolder(const std::filesystem::path& name);  // only if it is empty then
  [[nodiscard]] static Leftover process(pid_t child);                            // killed; nobody waits for it
  Leftover(Leftover&& other) noexcept;
  Leftover& operator=(Leftover&& other) noexcept;
  ~Leftover() { release(); }

  // It is gone, or is to stay: a file that was renamed, a process that ended.
  void release() noexcept;

 private:
  explicit Leftover(std::uint64_t number) : number_(number) {}
  std::uint64_t number_ = 0;  // 0: of nothing
};

// The last thing that a process does before _exit(): everything that is left goes, the newest first, and nothing new
// can be made any more: who tries waits for the process's end. Throws nothing.
void endLeftovers() noexcept;

}  // namespace palpate
