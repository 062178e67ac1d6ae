// SPDX-License-Identifier: Apache-2.0
// apps/check/check_page.hpp: the checks of many volumes as a Markdown page: what was compared where, and the results.
// Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/check/check.hpp"

namespace palpate {

// How the checks were run.
struct CheckRun {
  std::string command, commit, machine;
  std::vector<std::string> left_out;  // what was not checked, and why
};

// A row for each filter, operator and kind of edit, over all volumes and parameters. Files have no folder here.
[[nodiscard]] std::string checkPage(std::span<const Check> checks, const CheckRun& run);

}  // namespace palpate
