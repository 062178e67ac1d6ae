// SPDX-License-Identifier: Apache-2.0
// apps/supervise/child_start.hpp: starts a program as a child that is told when its supervisor dies. Linux only.
//
// The child
// - is the leader of a process group of its own: Ctrl-C in a terminal reaches it only if it is passed on, and it should
//   not read from the terminal, since the system stops who does so in the background;
// - gets SIGTERM when the thread that started it ends, however that ends. It can then end in good order: a servo brings
//   its force to zero first; SIGKILL would leave the hand to the device's watchdog. A child that goes on after SIGTERM
//   is not killed. The system sends nothing to a program whose file has capabilities or a set-user-ID bit;
// - inherits the descriptors 0, 1 and 2 and no others, though they were opened without O_CLOEXEC;
// - begins with no signal blocked and all at their defaults, but for SIGHUP, which stays ignored where it is (nohup).
// Its environment and limits are this process's.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace palpate {

// Starts `argv`: a program and its arguments. A program without '/' in its name is looked for along PATH. Gives the
// process id when the program runs. The caller waits for it (waitpid); until then the id is also that of its group.
// Throws Error, which names the program and `name`: kNotFound if there is no such program, kIo if it or a process
// cannot be started, kBadInput if argv is empty.
// Thread: a set-up thread that lives as long as the child shall. Blocks: for a fork and an exec.
[[nodiscard]] pid_t startChild(const std::string& name, const std::vector<std::string>& argv);

}  // namespace palpate
