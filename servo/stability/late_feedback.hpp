// SPDX-License-Identifier: Apache-2.0
// servo/stability/late_feedback.hpp: how many roots of a loop whose feedback comes d ticks late lie inside the unit
// circle, at a cost that does not depend on d.
//
// The characteristic equation is f(z) = z^d A(z) + C(z) = 0 with A of higher degree than C; A is the loop without
// feedback. By the argument principle, the argument of f grows by pi for each root inside while z goes from 1 to -1 on
// the upper half of the circle. There |z^d A| = |A| whatever d is, so the half circle falls into arcs on which one of
// the terms is the larger one throughout. On these, f is that term times a number of positive real part, and the
// argument of each factor of A and C is known in closed form. So is that of z^d. Nothing is sampled.
//   A and C are given as factors in zeta = z - 1: the roots of a loop of short ticks lie near z = 1, where powers of z
// cancel. Thread: any. Cost: some microseconds; allocates. Errors: none; all numbers are finite.
#pragma once

#include <vector>

namespace palpate {

// constant + linear zeta + square zeta^2, real. All are zero only where there is no feedback, in C.
struct LoopFactor {
  double constant = 0, linear = 0, square = 0;
};

struct LateFeedback {
  std::vector<LoopFactor> open;      // A
  std::vector<LoopFactor> feedback;  // C
  int delay_ticks = 0;               // d
};

// Counted with their multiplicity. A root on the circle itself may count as either.
[[nodiscard]] int rootsInside(const LateFeedback& loop);
// Whether all of them are. One at z = 1 exactly is not.
[[nodiscard]] bool allInside(const LateFeedback& loop);

}  // namespace palpate
