// SPDX-License-Identifier: Apache-2.0
// base/other_version.hpp: the refusal of what only a program of another version would say or share. Any thread.
#pragma once

#include <string>

#include "base/error.hpp"

namespace palpate {

// Error(kBadInput), with the remedy to start programs of one version.
[[nodiscard]] Error otherVersion(const std::string& input, const std::string& reason);
// Throws it.
[[noreturn]] void refuseOtherVersion(const std::string& input, const std::string& reason);

}  // namespace palpate
