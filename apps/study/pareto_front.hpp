// SPDX-License-Identifier: Apache-2.0
// apps/study/pareto_front.hpp: which of several choices are worth taking when both cost and error count: those that no
// other choice beats. Any thread. Cost: one sort.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

// Less is better of both.
struct CostAndError {
  double cost = 0, error = 0;
};

// Whether `a` is at least as good as `b` in both, and better in one.
[[nodiscard]] constexpr bool dominates(const CostAndError& a, const CostAndError& b) noexcept {
  return a.cost <= b.cost && a.error <= b.error && (a.cost < b.cost || a.error < b.error);
}

// The choices that no other one dominates, by ascending cost (equal ones in their order in the list). A choice with a
// figure that is NaN dominates none and is never one of them. Kung, Luccio and Preparata, "On finding the maxima of a
// set of vectors" (J. ACM 22, 1975), in two dimensions.
[[nodiscard]] std::vector<std::size_t> paretoFront(const std::vector<CostAndError>& choices);

}  // namespace palpate
