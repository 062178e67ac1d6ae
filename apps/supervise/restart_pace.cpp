// SPDX-License-Identifier: Apache-2.0
#include "apps/supervise/restart_pace.hpp"

#include <algorithm>

namespace palpate {

std::optional<double> RestartPace::afterDeath(double died_s, double lived_s) {
  if (lived_s >= limits_.steady_s) next_wait_s_ = 0;
  if (lived_s >= limits_.short_life_s) {
    short_lives_.clear();
  } else {
    short_lives_.push_back(died_s);
    while (died_s - short_lives_.front() > limits_.short_lives_within_s) short_lives_.pop_front();
    if (static_cast<int>(short_lives_.size()) >= limits_.most_short_lives) return std::nullopt;
  }
  const double wait_s = next_wait_s_;
  next_wait_s_ = wait_s == 0 ? limits_.first_wait_s : std::min(2 * wait_s, limits_.most_wait_s);
  return wait_s;
}

}  // namespace palpate
