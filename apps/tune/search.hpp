// SPDX-License-Identifier: Apache-2.0
// apps/tune/search.hpp: which candidates are tried, in which order, and what is left of them.
//
// The search knows no engine: `feel` makes a trial. One thread. Cost: at most mostRuns() calls.
#pragma once

#include <functional>
#include <vector>

#include "apps/tune/goal.hpp"

namespace palpate {

// The values of each choice. The scene's own are among them, but for a window larger than needed: one that holds the
// whole volume is enough.
struct SearchSpace {
  Candidate own;                          // what the scene says
  std::vector<std::string> filters;       // the scene's first
  std::vector<std::string> more_filters;  // tried only if one of `filters` is truer than the scene's
  std::vector<std::string> operators;     // the scene's first
  std::vector<std::string> samples;       // floats first
  std::vector<int> ns;                    // ascending
  std::vector<int> windows;               // ascending [voxel]
};

struct SpaceRequest {
  bool filters_and_operators = false;  // may be chosen: the exact surface is known
  bool renews_planes = true;           // the algorithm uses n
  int longest_edge = 0;                // of the volume [voxel]; larger windows would be the same
};
[[nodiscard]] SearchSpace searchSpace(const Scene& scene, const SpaceRequest& request);

// The most calls of `feel` that a search makes in this space.
[[nodiscard]] std::size_t mostRuns(const SearchSpace& space);

struct Found {
  std::vector<Trial> trials;       // each candidate once, in the order of their trials
  Trial base;                      // the truest settings of all but filter and operator, which are the scene's
  std::vector<std::size_t> picks;  // the trials that meet the goal: the finalists, then the others, the best first
  std::size_t as_good = 0;         // how many of them are as good as the best, but for chance
};

// So many candidates are measured again, in turns, kRounds times.
inline constexpr std::size_t kFinalists = 6;
inline constexpr int kRounds = 5;

// 1. The scene's own settings.
//    The truest settings of all but filter and operator come next: the base. If there is no contact on its path, the
//    search ends there, and `picks` is empty.
// 2. Filters, operators and windows, one choice at a time, with all others as true as they can be (n = 1, floats, the
//    largest window). Of filters and operators the scene's own and the truest stay; of windows the two that cost least
//    among those that keep the contact and err no more than the largest.
// 3. Every combination of what stayed, with both storages and every n.
// 4. Around the best of these: every value of one choice but the filters of `more_filters`, with the rest as it is.
// 5. The best for the goal are measured again in turns, and the median of their times counts. If another one is the
//    best then, step 4 is taken around it, too.
//
// `feel` may throw; the search ends then. A trial is two calls, and each round of a finalist is one more. Of these the
// worst counts, but for the time: the quicker of the two, then the median of the rounds.
[[nodiscard]] Found search(const Goal& goal, const SearchSpace& space,
                           const std::function<Trial(const Candidate& candidate)>& feel);

}  // namespace palpate
