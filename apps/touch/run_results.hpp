// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_results.hpp: the files that a run leaves in its folder, and a check that files of these names from
// elsewhere are not replaced. Set-up code, any thread.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

inline constexpr std::array<const char*, 4> kRunResults = {"trace.csv", "summary.json", "report.html", "view.png"};

// The files in the folder that have a name of kRunResults but are no run's result: no summary.json of a run lists them.
// A run's summary counts as its own result. Only plain files are looked at; OutputFolder::publish() refuses all else.
[[nodiscard]] std::vector<std::string> foreignResults(const std::filesystem::path& folder);

// Throws Error(kBadInput) if there is such a file, so that a run never replaces what another program wrote.
void refuseForeignResults(const std::filesystem::path& folder);

}  // namespace palpate
