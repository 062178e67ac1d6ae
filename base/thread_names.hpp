// SPDX-License-Identifier: Apache-2.0
// base/thread_names.hpp: names for the program's threads, as debuggers and `top -H` show them, and which threads there
// are. Linux only. Cost: some system calls, so a servo names itself before its first tick.
#pragma once

#include <string>
#include <thread>
#include <vector>

namespace palpate {

// Names the calling thread; 15 characters at most. A name that the system refuses is left out.
void nameThisThread(const char* name) noexcept;
// The same from outside, by who made it: it has its name when this returns, whether it has run or not.
void nameThread(std::thread::native_handle_type thread, const char* name) noexcept;

// The names of the threads that the process has now, the oldest first. A thread that nobody named has the name of the
// program or of the thread that made it. A driver's threads are among them. Any thread.
[[nodiscard]] std::vector<std::string> threadNames();

}  // namespace palpate
