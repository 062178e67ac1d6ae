// SPDX-License-Identifier: Apache-2.0
// apps/palpate/run_self.hpp: runs this program again as a child process. Linux only; set-up code.
#pragma once

#include <string>
#include <vector>

namespace palpate {

// Runs it with these words after its name, and waits. Its messages go where this program's go; what it prints is
// dropped. Ctrl-C reaches it too, and this waits for its end. Returns "" if it ended with status 0, else why not, in
// words. Throws Error(kIo) if no process can be started.
[[nodiscard]] std::string runSelf(const std::vector<std::string>& words);

}  // namespace palpate
