// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/reasons.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/report/words.hpp"
#include "base/byte_size.hpp"

namespace palpate {
namespace {

constexpr std::size_t kNamed = 2;  // other values in a sentence

// What a value costs more than the picked one; empty if nothing.
std::string moreCost(const Trial& other, const Trial& picked) {
  const double longer_us = other.loop_us - picked.loop_us;
  if (longer_us > std::max(kSameTime * picked.loop_us, kSameTime_us))
    return fmt::format("takes {} us a tick more", figureText(longer_us));
  if (static_cast<double>(other.memory_bytes) > (1 + kSameMemory) * static_cast<double>(picked.memory_bytes))
    return fmt::format("takes {} more", inMiB(other.memory_bytes - picked.memory_bytes));
  if (other.start_ms > (1 + kSameStart) * picked.start_ms)
    return fmt::format("starts {} ms later", figureText(other.start_ms - picked.start_ms));
  return "";
}

std::string compared(const Trial& other, const Trial& picked, const Trial& base, const Goal& goal) {
  if (!other.impossible.empty()) return fmt::format("cannot be: {}", other.impossible);
  if (!holdsContact(other, base)) {
    return other.faulty_ticks > base.faulty_ticks ? "raises faults of the window" : "loses the contact";
  }
  std::string error = fmt::format("errs by {} N", figureText(other.error_N));
  std::string cost = moreCost(other, picked);
  if (!meets(goal, other, base)) {
    return goal.kind == Goal::Kind::kError ? error : fmt::format("takes {} us a tick", figureText(other.loop_us));
  }
  const bool truer = other.error_N < picked.error_N * (1 - kSameError);
  const bool worse = other.error_N > picked.error_N * (1 + kSameError);
  if (goal.kind == Goal::Kind::kBudget && worse) return error;
  if (!cost.empty()) return cost;
  if (worse) return error + " and costs no less";
  return truer ? error + " and costs as much" : "does as well";
}

double orderOn(Axis axis, const Trial& trial) {
  return axis == Axis::kN ? trial.candidate.n : trial.candidate.window_edge;
}

// The nearest value on each side.
std::vector<const Trial*> neighbours(Axis axis, const Trial& picked, const std::vector<const Trial*>& others) {
  const Trial *below = nullptr, *above = nullptr;
  for (const Trial* other : others) {
    const double at = orderOn(axis, *other), here = orderOn(axis, picked);
    if (at < here && (below == nullptr || at > orderOn(axis, *below))) below = other;
    if (at > here && (above == nullptr || at < orderOn(axis, *above))) above = other;
  }
  std::vector<const Trial*> near;
  for (const Trial* one : {above, below}) {
    if (one != nullptr) near.push_back(one);
  }
  return near;
}

}  // namespace

std::string figureText(double figure) {
  return shortNumber(figure);
}

std::string reasonFor(Axis axis, const Trial& picked, std::span<const Trial> trials, const Trial& base,
                      const Goal& goal) {
  std::vector<const Trial*> others;
  for (const Trial& trial : trials) {
    if (differOnlyOn(axis, trial.candidate, picked.candidate)) others.push_back(&trial);
  }
  if (axis == Axis::kN || axis == Axis::kWindow) {
    others = neighbours(axis, picked, others);
  } else {
    const auto figure = [&](const Trial* trial) {
      const double value = goal.figureOf(*trial);
      return std::pair(!holdsContact(*trial, base), std::isnan(value) ? INFINITY : value);
    };
    std::ranges::stable_sort(others, {}, figure);
    if (others.size() > kNamed) others.resize(kNamed);
  }
  std::vector<std::string> sentences;
  for (const Trial* other : others)
    sentences.push_back(valueOn(axis, other->candidate) + " " + compared(*other, picked, base, goal));
  return fmt::format("{}", fmt::join(sentences, "; "));
}

}  // namespace palpate
