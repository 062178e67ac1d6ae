// SPDX-License-Identifier: Apache-2.0
// service/sandbox/memory_images.hpp: from now on nobody of this user looks into the process.
#pragma once

namespace palpate {

// No image of its memory on a crash (RLIMIT_CORE), and no debugger but root's (PR_SET_DUMPABLE): /proc/PID is root's,
// too. False: the system refuses one of both; errno says why. Any thread. Two system calls. Linux only.
[[nodiscard]] bool refuseMemoryImages() noexcept;

}  // namespace palpate
