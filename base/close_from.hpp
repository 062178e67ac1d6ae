// SPDX-License-Identifier: Apache-2.0
// base/close_from.hpp: leaves the files behind that whoever started this process, or this process itself, has opened.
//
// Only system calls: also for a child between fork() and exec(), where nothing may be allocated. Any thread. Cost: one
// call; before Linux 5.9 (5.11 for kInPrograms) one for each number below the limit of open files, a tenth of a second
// at most. Linux only.
#pragma once

namespace palpate {

enum class Closing {
  kNow,
  kInPrograms,  // that this process becomes (FD_CLOEXEC); here they stay open
};

// All descriptors from `first` on but for `kept`, which may be below `first`.
void closeFrom(int first, Closing closing, int kept = -1) noexcept;

}  // namespace palpate
