// SPDX-License-Identifier: Apache-2.0
// apps/supervise/hopeless_statuses.hpp: exit statuses after which an engine or a servo is not started again, since it
// would only end in the same way. `palpate serve --supervise` heeds them (supervisor.hpp), and so do the units in
// share/systemd/user (RestartPreventExitStatus). Any thread; allocates.
#pragma once

#include <vector>

#include "base/error.hpp"

namespace palpate {

// What an engine is given cannot be used, or is not there.
[[nodiscard]] inline std::vector<int> hopelessForEngine() {
  return {exitStatus(Error::Code::kBadInput), exitStatus(Error::Code::kNotFound)};
}

// The same, and ceilings that cannot be read: a servo that is started again could not read them then either.
[[nodiscard]] inline std::vector<int> hopelessForServo() {
  return {exitStatus(Error::Code::kBadInput), exitStatus(Error::Code::kNotFound), exitStatus(Error::Code::kIo)};
}

}  // namespace palpate
