// SPDX-License-Identifier: Apache-2.0
// apps/tune/tune_report.hpp: what `palpate tune` found, for a terminal and as JSON. Any thread.
#pragma once

#include <string>

#include "apps/tune/tune_job.hpp"

namespace palpate {

// A table of the candidates on the front of error and time, of the choice, of the scene's own and of those one step
// from the choice; then what was picked and why, or that nothing was.
[[nodiscard]] std::string tuneWords(const TuneRequest& request, const TuneResult& result);

// Every trial. NaN becomes null.
[[nodiscard]] std::string tuneJson(const TuneRequest& request, const TuneResult& result);

}  // namespace palpate
