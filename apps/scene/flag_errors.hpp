// SPDX-License-Identifier: Apache-2.0
// apps/scene/flag_errors.hpp: gives the servo's errors the names of flags and keys. Any thread.
//
// The option table checks ranges. The servo refuses settings that do not fit together (a dynamic friction above the
// static one), but knows only its own names for its parameters.
#pragma once

#include "base/error.hpp"

namespace palpate {

// "dynamic friction: ..." becomes "--friction-dynamic (key contact.friction_dynamic): ..."; others stay as they are.
[[nodiscard]] Error withFlag(const Error& error);

}  // namespace palpate
