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

std::vector<Criterion> criteriaOf(const Goal& goal) {
  if (goal.kind == Goal::Kind::kError) return {kByTime, kByMemory, kByStart};
  return {kByError, kByTime, kByMemory, kByStart};
}

std::vector<std::size_t> thoseThatMeet(const Goal& goal, std::span<const Trial> trials, const Trial& base) {
  std::vector<std::size_t> meeting;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (meets(goal, trials[i], base)) meeting.push_back(i);
  }
  return meeting;
}

// The best of `left`: those that are equal to the least by one criterion are judged by the next.
std::vector<std::size_t> bestOf(std::vector<std::size_t> left, std::span<const Trial> trials, const Goal& goal) {
  for (const Criterion& by : criteriaOf(goal)) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : left) least = std::min(least, by.value(trials[i]));
    std::erase_if(
        left, [&](std::size_t i) { return by.value(trials[i]) > std::max(least * (1 + by.share), least + by.least); });
  }
  return left;
}

// Chance tells equal ones apart, were it not for this: the nearest to the scene's settings, and of these the truest.
std::size_t nearestToOwn(const std::vector<std::size_t>& equal, std::span<const Trial> trials, const Candidate& own) {
  const auto far = [&](std::size_t i) {
    const auto changed = std::ranges::count_if(
        kAxes, [&](Axis axis) { return valueOn(axis, trials[i].candidate) != valueOn(axis, own); });
    return std::pair(changed, trials[i].error_N);
  };
  return *std::ranges::min_element(equal, {}, far);
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

std::vector<std::size_t> ranked(const Goal& goal, std::span<const Trial> trials, const Trial& base,
                                const Candidate& own) {
  std::vector<std::size_t> left = thoseThatMeet(goal, trials, base), order;
  while (!left.empty()) {
    order.push_back(nearestToOwn(bestOf(left, trials, goal), trials, own));
    std::erase(left, order.back());
  }
  return order;
}

std::size_t countAsGood(const Goal& goal, std::span<const Trial> trials, const Trial& base) {
  return bestOf(thoseThatMeet(goal, trials, base), trials, goal).size();
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
