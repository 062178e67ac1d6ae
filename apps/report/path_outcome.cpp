// SPDX-License-Identifier: Apache-2.0
#include "apps/report/path_outcome.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/report/words.hpp"

namespace palpate {
namespace {

const PathPhase* phaseOf(const std::vector<PathPhase>& phases, const char* name) {
  const auto found = std::find_if(phases.begin(), phases.end(), [&](const PathPhase& p) { return p.name == name; });
  return found == phases.end() ? nullptr : &*found;
}

// The time until the next record. Grid points that were left out belong to the tick before them.
double duration(const std::vector<TickRecord>& records, std::size_t i, double rate_hz) {
  const auto ticks = i + 1 < records.size() ? records[i + 1].tick - records[i].tick : 1;
  return static_cast<double>(ticks) / rate_hz;
}

}  // namespace

PathOutcome pathOutcome(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases, double rate_hz) {
  PathOutcome outcome;
  const PathPhase *slide = phaseOf(phases, "slide"), *retreat = phaseOf(phases, "retreat");
  if (slide == nullptr || retreat == nullptr) return outcome;
  bool touched = false;
  double free_s = 0;  // time without contact in the retreat so far
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TickRecord& now = records[i];
    touched = touched || now.in_contact;
    if (touched && !now.in_contact && now.time_s >= slide->begin_s && now.time_s < slide->end_s)
      outcome.lost_s += duration(records, i, rate_hz);
    if (now.time_s < retreat->begin_s) continue;
    if (now.in_contact && free_s >= kFree_s) ++outcome.retreat_touches;
    free_s = now.in_contact ? 0 : free_s + duration(records, i, rate_hz);
  }
  // A run that was stopped earlier has not reached the end of the retreat.
  constexpr double kTicks = 1.5;  // the last one begins a tick before the end
  if (!records.empty() && records.back().time_s >= retreat->end_s - kTicks / rate_hz)
    outcome.ends_in_contact = records.back().in_contact;
  return outcome;
}

std::string pathClause(const PathOutcome& outcome) {
  std::string text;
  if (outcome.lost_s > 0)
    text += fmt::format("; it left the surface for {} s of the slide", shortNumber(outcome.lost_s));
  if (outcome.retreat_touches > 0) text += "; the retreat touched the object again";
  if (outcome.ends_in_contact) text += "; the retreat ended in contact";
  return text;
}

}  // namespace palpate
