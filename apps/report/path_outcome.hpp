// SPDX-License-Identifier: Apache-2.0
// apps/report/path_outcome.hpp: whether a run on a built path went as planned: in contact during the whole slide, out
// of contact at the end of the retreat. Any thread. Cost: one pass over the records.
#pragma once

#include <string>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct PathOutcome {
  double lost_s = 0;             // time without contact during the slide; 0 if there was no contact at all [s]
  int retreat_touches = 0;       // contacts that began in the retreat, after kFree_s or more without contact there
  bool ends_in_contact = false;  // the retreat ended in contact
};

inline constexpr double kFree_s = 5e-3;  // a shorter gap does not end a contact: it is noise

// `rate_hz` of the servo [1/s]. A path without phases, and a phase that was not reached, count as going as planned.
[[nodiscard]] PathOutcome pathOutcome(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases,
                                      double rate_hz);

// "; it left the surface for 0.4 s of the slide; the retreat ended in contact"; empty if all went as planned.
[[nodiscard]] std::string pathClause(const PathOutcome& outcome);

}  // namespace palpate
