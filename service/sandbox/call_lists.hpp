// SPDX-License-Identifier: Apache-2.0
// service/sandbox/call_lists.hpp: which system calls a servo makes, and which nobody makes by mistake. Constants.
//
// A name that a kind of processor lacks ("open" on aarch64) is passed over there. Calls of which only some arguments
// are allowed are in call_filter.cpp, and in neither list.
#pragma once

#include <span>

namespace palpate {

// With whatever arguments.
[[nodiscard]] std::span<const char* const> allowedCalls() noexcept;

// Running another program, looking into another process, changing the kernel or what the process sees of the system.
[[nodiscard]] std::span<const char* const> deadlyCalls() noexcept;

}  // namespace palpate
