// SPDX-License-Identifier: Apache-2.0
// apps/tune/reasons.hpp: why a candidate was picked, one sentence for each choice, from the trials that differ from it
// in that choice alone. Any thread.
#pragma once

#include <span>
#include <string>

#include "apps/tune/goal.hpp"

namespace palpate {

// "13 errs by 0.07 N; 5 takes 0.02 us a tick more". At most two others are named: on an ordered choice the nearest on
// each side, otherwise those that come nearest to the goal. Empty if no other value was tried.
[[nodiscard]] std::string reasonFor(Axis axis, const Trial& picked, std::span<const Trial> trials, const Trial& base,
                                    const Goal& goal);

// "0.0123": three significant digits at most, without an exponent where it can be.
[[nodiscard]] std::string figureText(double figure);

}  // namespace palpate
