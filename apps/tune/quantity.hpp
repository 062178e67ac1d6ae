// SPDX-License-Identifier: Apache-2.0
// apps/tune/quantity.hpp: a force or a time with its unit, as a user writes it: "0.05N", "50 mN", "200us", "0.2ms".
// Any thread.
#pragma once

#include <string>

namespace palpate {

// In newtons and in microseconds. `where`: the flag, for the message. Throws Error(kBadInput): no number; no unit or
// another one; zero, a negative or a not finite value.
[[nodiscard]] double forceOf_N(const std::string& text, const std::string& where);
[[nodiscard]] double timeOf_us(const std::string& text, const std::string& where);

// The same back: with the fewest digits that are read as this value, in newtons or microseconds.
[[nodiscard]] std::string forceText(double force_N);
[[nodiscard]] std::string timeText(double time_us);

}  // namespace palpate
