// SPDX-License-Identifier: Apache-2.0
// apps/check/check_page.hpp: checks of many volumes as a page (Markdown) that can be kept: what was compared where, and
// what came out. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/check/check.hpp"

namespace palpate {

// How the checks came about.
struct CheckRun {
  std::string command, commit, machine;
  std::vector<std::string> left_out;  // and why
};

// A row for each filter, operator and kind of edit, over all volumes, whatever its parameters were there. Of files the
// name is told, not the folder.
[[nodiscard]] std::string checkPage(std::span<const Check> checks, const CheckRun& run);

}  // namespace palpate
