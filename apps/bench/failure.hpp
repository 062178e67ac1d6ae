// SPDX-License-Identifier: Apache-2.0
// apps/bench/failure.hpp: what a part of a bench failed with, in words, so that the parts before it are not lost and
// those behind it are measured. Any thread.
#pragma once

#include <functional>
#include <string>

namespace palpate {

// Runs `work`. Empty: it ended well. Throws Error(kCancelled) on, which ends the whole bench.
[[nodiscard]] std::string failureOf(const std::function<void()>& work);

}  // namespace palpate
