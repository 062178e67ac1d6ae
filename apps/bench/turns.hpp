// SPDX-License-Identifier: Apache-2.0
// apps/bench/turns.hpp: times several ways to do one job. They run in turns, so that other load on the machine meets
// all alike. One thread.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "apps/rivals/rivals.hpp"

namespace palpate {

struct Contender {
  std::string library, way;
  std::function<RunCost()> run;
  bool own = false;  // Palpate's: never left out for being slow; its first run, which compiles kernels, never counts
};

struct TurnsPlan {
  int most_rounds = 9;
  double budget_s = 6;    // time for all rounds of one contender; at least one round is run
  double longest_s = 12;  // a rival that would need more processor time for one run is left out
};

struct TurnsOutcome {
  std::string library, way;
  std::vector<double> wall_ms, cpu_ms;  // of each round
  std::string left_out;                 // why there are no rounds, or no more; empty: there are

  void add(const RunCost& cost) {
    wall_ms.push_back(cost.wall_ms);
    cpu_ms.push_back(cost.cpu_ms);
  }
};

// Runs a part of a bench and returns why it failed, in words; empty: it did not. So the other parts are still measured.
// Only Error(kCancelled) passes through and ends the whole bench.
[[nodiscard]] std::string failureOf(const std::function<void()>& work);

class Turns {
 public:
  explicit Turns(const TurnsPlan& plan) : plan_(plan) {}

  // Runs every contender once to warm up, then in rounds. A rival's warm-up of more than a second counts as a round.
  // `job`, `voxels`: the time of a run is predicted from the processor time per voxel of earlier runs of this job,
  // which is reliable on a busy machine too. A contender that throws is left out, with the reason; Error(kCancelled)
  // passes through.
  [[nodiscard]] std::vector<TurnsOutcome> take(const std::string& job, double voxels,
                                               const std::vector<Contender>& entrants);

 private:
  TurnsPlan plan_;
  std::map<std::string, double> cpu_ms_per_voxel_;  // by job, library and way
};

}  // namespace palpate
