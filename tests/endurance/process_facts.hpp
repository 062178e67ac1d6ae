// SPDX-License-Identifier: Apache-2.0
// What a running process holds, as the kernel says.
#pragma once

#include <cstddef>
#include <string>

#include <sys/types.h>

namespace palpate {

// Anonymous memory that lies in RAM: what the process has allocated, without files that it maps [byte]. 0: it is gone.
[[nodiscard]] double ownMemory(pid_t process);
[[nodiscard]] std::size_t openDescriptorsOf(pid_t process);
[[nodiscard]] std::size_t threadsOf(pid_t process);
// A child of that name, of any thread; 0: none.
[[nodiscard]] pid_t childOf(pid_t process, const std::string& name);

}  // namespace palpate
