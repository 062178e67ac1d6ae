// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/goal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

struct Criterion {
  double (*value)(const Trial& trial);
  double share;      // values within this share above the least count as equal
  double least = 0;  // or within this difference
};

constexpr double kNegligibleError_N = 1e-6;

const Criterion kByTime = {[](const Trial& t) { return t.loop_us; }, kSameTime, kSameTime_us};
const Criterion kByMemory = {[](const Trial& t) { return static_cast<double>(t.memory_bytes); }, kSameMemory};
const Criterion kByStart = {[](const Trial& t) { return t.start_ms; }, kSameStart};
const Criterion kByError = {[](const Trial& t) { return t.error_N; }, kSameError, kNegligibleError_N};
const Criterion kByExactError = {[](const Trial& t) { return t.error_N; }, 0};

std::vector<Criterion> criteriaOf(const Goal& goal) {
  if (goal.kind == Goal::Kind::kError) return {kByTime, kByMemory, kByStart, kByExactError};
  return {kByError, kByTime, kByMemory, kByStart};
}

// The best of `left`: those that are equal to the least by one criterion are judged by the next.
std::size_t bestOf(std::vector<std::size_t> left, std::span<const Trial> trials,
                   const std::vector<Criterion>& criteria) {
  for (const Criterion& by : criteria) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : left) least = std::min(least, by.value(trials[i]));
    std::erase_if(
        left, [&](std::size_t i) { return by.value(trials[i]) > std::max(least * (1 + by.share), least + by.least); });
  }
  return left.front();
}

}  // namespace

double marginOf(const Goal& goal) {
  return goal.kind == Goal::Kind::kError ? kErrorMargin : kTimeMargin;
}

bool holdsContact(const Trial& trial, const Trial& base) {
  constexpr double kMayLose = 0.01;
  return trial.impossible.empty() && !std::isnan(trial.error_N) &&
         trial.contact_share >= base.contact_share - kMayLose && trial.faulty_ticks <= base.faulty_ticks;
}

bool meets(const Goal& goal, const Trial& trial, const Trial& base) {
  return holdsContact(trial, base) && goal.figureOf(trial) * marginOf(goal) <= goal.bound;
}

std::vector<std::size_t> ranked(const Goal& goal, std::span<const Trial> trials, const Trial& base) {
  std::vector<std::size_t> left, order;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (meets(goal, trials[i], base)) left.push_back(i);
  }
  const std::vector<Criterion> criteria = criteriaOf(goal);
  while (!left.empty()) {
    order.push_back(bestOf(left, trials, criteria));
    std::erase(left, order.back());
  }
  return order;
}

std::size_t nearestTo(const Goal& goal, std::span<const Trial> trials, const Trial& base) {
  const auto rank = [&](const Trial& trial) {
    const double figure = goal.figureOf(trial);
    return std::pair(!holdsContact(trial, base), std::isnan(figure) ? std::numeric_limits<double>::infinity() : figure);
  };
  const auto nearest = std::ranges::min_element(trials, {}, rank);
  return static_cast<std::size_t>(nearest - trials.begin());
}

}  // namespace palpate
