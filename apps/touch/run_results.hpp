// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_results.hpp: the files that a run leaves in its folder, and which of them an earlier run left there.
// Set-up code, any thread.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

inline constexpr std::array<const char*, 4> kRunResults = {"trace.csv", "summary.json", "report.html", "view.png"};

// Those of kRunResults in the folder that are nobody's business to replace: no summary.json of a run lists them. The
// summary of a run lists itself. Nothing that is no file: OutputFolder::publish() refuses that.
[[nodiscard]] std::vector<std::string> foreignResults(const std::filesystem::path& folder);

// Throws Error(kBadInput) where there is one: a folder of results is that of one run, and what others wrote is theirs.
void refuseForeignResults(const std::filesystem::path& folder);

}  // namespace palpate
