// SPDX-License-Identifier: Apache-2.0
// apps/bench/turns.hpp: several ways to do one job, run in turns, so that whatever else the machine does meets all
// alike. One thread.
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
  bool own = false;  // Palpate's: never left out for being slow, and its first run, which compiles, never counts
};

struct TurnsPlan {
  int most_rounds = 9;
  double budget_s = 6;    // for all rounds of one entrant; there is always one
  double longest_s = 12;  // who would take more processor time than this for one run is left out
};

struct TurnsOutcome {
  std::string library, way;
  std::vector<double> wall_ms, cpu_ms;  // of each round
  std::string left_out;                 // why there is none, or no more

  void add(const RunCost& cost) {
    wall_ms.push_back(cost.wall_ms);
    cpu_ms.push_back(cost.cpu_ms);
  }
};

// What a part of a bench failed with, in words, so that the parts before it are not lost and those behind it are
// measured. Empty: it ended well. Throws Error(kCancelled) on, which ends the whole bench.
[[nodiscard]] std::string failureOf(const std::function<void()>& work);

class Turns {
 public:
  explicit Turns(const TurnsPlan& plan) : plan_(plan) {}

  // Everyone runs once to warm up; a rival's run of more than a second counts already, since a second one would be no
  // different. `job` and `voxels`: the processor time that they took before, per voxel, says how long this will take,
  // on a busy machine too. Who throws Error is left out, with its words; Error(kCancelled) is passed on.
  [[nodiscard]] std::vector<TurnsOutcome> take(const std::string& job, double voxels,
                                               const std::vector<Contender>& entrants);

 private:
  TurnsPlan plan_;
  std::map<std::string, double> cpu_ms_per_voxel_;  // by job, library and way
};

}  // namespace palpate
