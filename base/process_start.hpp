// SPDX-License-Identifier: Apache-2.0
// base/process_start.hpp: when this process began. Any thread; no cost after the first call.
#pragma once

#include <cstdint>

namespace palpate {

// Of CLOCK_MONOTONIC [ns]. The system keeps a process's start to 10 ms only. So the first call, which main() makes
// before anything else, takes the processor time used until then as the time that has passed: until main() there is one
// thread, which loads libraries. What it waited for, for another process or for the disk, is not counted.
[[nodiscard]] std::int64_t processStart_ns() noexcept;

}  // namespace palpate
