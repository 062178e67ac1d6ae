// SPDX-License-Identifier: Apache-2.0
// apps/supervise/restart_pace.hpp: when a process that died is started again, and when that is given up.
//
// The first restart is immediate. Each further one waits twice as long as the one before, up to a limit, until a life
// was long. Deaths that follow each other at once are no accidents: after some of them it is given up.
// Arithmetic only: one thread, no clock of its own, no errors.
#pragma once

#include <deque>
#include <optional>

namespace palpate {

struct RestartLimits {
  double first_wait_s = 0.1;         // before the second restart; then doubled [s]
  double most_wait_s = 5;            // [s]
  double steady_s = 10;              // after a life as long as this the next restart is immediate again [s]
  double short_life_s = 1;           // a life below this is a short one [s]
  int most_short_lives = 5;          // with so many in a row ...
  double short_lives_within_s = 10;  // ... that ended within this time it is given up [s]
};

class RestartPace {
 public:
  explicit RestartPace(const RestartLimits& limits) : limits_(limits) {}

  // To be told of each death: when it was, by any clock that only rises, and how long the process had lived. The time
  // to wait before the next start [s]; empty: give up.
  [[nodiscard]] std::optional<double> afterDeath(double died_s, double lived_s);

 private:
  RestartLimits limits_;
  double next_wait_s_ = 0;
  std::deque<double> short_lives_;  // when each ended [s]
};

}  // namespace palpate
