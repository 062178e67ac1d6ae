// SPDX-License-Identifier: Apache-2.0
// apps/console/interrupt.hpp: Ctrl-C ends long work in good order instead of killing it. A second one, half a second or
// more later, kills.
#pragma once

#include <string>

namespace palpate {

void catchInterrupts();  // from here on SIGINT and SIGTERM only set a flag; SIGXFSZ is ignored
[[nodiscard]] bool interrupted() noexcept;
// Error(kCancelled). `kept`: what there is of the work nevertheless, and what to do.
void throwIfInterrupted(const std::string& work, const std::string& kept = "nothing was written; start it again");

}  // namespace palpate
