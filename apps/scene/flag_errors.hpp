// SPDX-License-Identifier: Apache-2.0
// apps/scene/flag_errors.hpp: what the servo refuses, with the names that a user has for it. Any thread.
//
// Ranges are the option table's. What is left are settings that do not fit together (a dynamic friction above the static
// one); the servo finds those, and knows its parameters' names only.
#pragma once

#include "base/error.hpp"

namespace palpate {

// "dynamic friction: ..." becomes "--friction-dynamic (key contact.friction_dynamic): ..."; others stay as they are.
[[nodiscard]] Error withFlag(const Error& error);

}  // namespace palpate
