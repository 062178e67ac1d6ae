// SPDX-License-Identifier: Apache-2.0
// apps/tune/goal.hpp: what a user asks of `palpate tune`, and which of several trials is best for it. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/tune/candidate.hpp"

namespace palpate {

// Either an error that may not be exceeded, and then the cheapest candidate is wanted, or a time, and then the truest.
struct Goal {
  enum class Kind { kError, kBudget };
  Kind kind = Kind::kError;
  double bound = 0;  // [N] or [us]

  [[nodiscard]] double figureOf(const Trial& trial) const {
    return kind == Kind::kError ? trial.error_N : trial.loop_us;
  }
  [[nodiscard]] const char* unit() const { return kind == Kind::kError ? "N" : "us"; }
};

// A candidate is picked only if its figure, times this, is within the bound. The error is the same in every run with
// the simulated clock; with the real one windows come a little later. A time depends on what else the machine does.
inline constexpr double kErrorMargin = 1.05;
inline constexpr double kTimeMargin = 1.4;
[[nodiscard]] double marginOf(const Goal& goal);

// A time of repeated runs differs by so much by chance, and memory and start by less. Costs that are nearer to each
// other count as equal.
inline constexpr double kSameTime = 0.1, kSameMemory = 0.01, kSameStart = 0.25, kSameError = 0.02;
inline constexpr double kSameTime_us = 0.02;

// Whether a trial was felt as `base` was: in contact for as long within one part in a hundred, without more faults.
[[nodiscard]] bool holdsContact(const Trial& trial, const Trial& base);

// Whether it was felt so, and its figure is within the bound with the margin.
[[nodiscard]] bool meets(const Goal& goal, const Trial& trial, const Trial& base);

// The trials that meet the goal, by their places in the list, the best first: for an error the cheapest by time, then
// memory, then start; for a budget the truest, then the cheapest. Of equal ones the first changes fewest of `own`, the
// scene's settings; of these the truest comes first.
[[nodiscard]] std::vector<std::size_t> ranked(const Goal& goal, std::span<const Trial> trials, const Trial& base,
                                              const Candidate& own);

// How many of them are as good as the best, but for chance.
[[nodiscard]] std::size_t countAsGood(const Goal& goal, std::span<const Trial> trials, const Trial& base);

// The place of the trial that comes nearest to the goal, whether it meets it or not. The list may not be empty.
[[nodiscard]] std::size_t nearestTo(const Goal& goal, std::span<const Trial> trials, const Trial& base);

}  // namespace palpate
