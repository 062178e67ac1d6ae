// SPDX-License-Identifier: Apache-2.0
// apps/bench/all_benches.hpp: the results of several benches on one page, as `palpate bench all` shows them. Any
// thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"

namespace palpate {

// What became of a bench.
struct BenchOutcome {
  std::string name, title;
  double seconds = 0;
  std::optional<BenchResult> result = {};
  std::string failure = {};  // why there is no result
  std::string page = {};     // its own page, relative to this one
};

// "servo: 31 of 32 targets hold, 41 s", or why there is no result.
[[nodiscard]] std::string outcomeInWords(const BenchOutcome& outcome);

// A table of the benches with links to their pages, the targets that do not hold, and then all targets. `command`: what
// the user gave; machine and commit are those of the results.
[[nodiscard]] std::string allBenchesPage(const std::vector<BenchOutcome>& outcomes, const std::string& command);

}  // namespace palpate
