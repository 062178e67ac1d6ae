// SPDX-License-Identifier: Apache-2.0
// apps/report/path_outcome.hpp: whether the tool kept to what a built path meant: on the surface all through the slide,
// off it at the end of the retreat. Any thread. Cost: one pass over the records.
#pragma once

#include <string>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct PathOutcome {
  double lost_s = 0;             // of the slide, without contact; 0 where there was never any [s]
  int retreat_touches = 0;       // that began in the retreat, after the tool had been free in it for kFree_s
  bool ends_in_contact = false;  // at the end of the retreat
};

inline constexpr double kFree_s = 5e-3;  // shorter gaps are a contact that ends in noise, not two touches

// `rate_hz` of the servo [1/s]. Nothing is wrong with a path without phases, nor with a phase that was not reached.
[[nodiscard]] PathOutcome pathOutcome(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases,
                                      double rate_hz);

// "; it left the surface for 0.4 s of the slide; the retreat ended in contact"; empty where all was as meant.
[[nodiscard]] std::string pathClause(const PathOutcome& outcome);

}  // namespace palpate
