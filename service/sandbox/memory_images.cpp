// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/memory_images.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>

namespace palpate {

// Of files' sizes and of processes there is no limit: messages go to a file that may be long already, memory that two
// processes share counts as a file, and processes are counted for the user, whose others may be many.
bool refuseMemoryImages() noexcept {
  const rlimit none = {0, 0};
  return setrlimit(RLIMIT_CORE, &none) == 0 && prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) == 0;
}

}  // namespace palpate
