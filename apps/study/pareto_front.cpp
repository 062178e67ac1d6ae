// SPDX-License-Identifier: Apache-2.0
#include "apps/study/pareto_front.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace palpate {

std::vector<std::size_t> paretoFront(const std::vector<CostAndError>& choices) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!std::isnan(choices[i].cost) && !std::isnan(choices[i].error)) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(choices[a].cost, choices[a].error, a) < std::tie(choices[b].cost, choices[b].error, b);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    // All before it cost no more. Of equal cost, those with the least error come first.
    const CostAndError* last = front.empty() ? nullptr : &choices[front.back()];
    const bool equal = last != nullptr && choices[i].cost == last->cost && choices[i].error == last->error;
    if (last == nullptr || choices[i].error < last->error || equal) front.push_back(i);
  }
  return front;
}

}  // namespace palpate
