// SPDX-License-Identifier: Apache-2.0
// tests/damage/campaign.hpp: many files damaged and read, and what came of it. Thread: as judge().
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/damage/damage.hpp"
#include "tests/damage/judge.hpp"

namespace palpate::damage {

struct Plan {
  std::size_t per_cell = 10;  // files for each format and each kind of damage alone; more where values are words
  std::size_t many = 0;       // files for each format with several kinds at once
  std::uint64_t seed = 1;
  std::string only;  // a part of the names of formats; "": all
  std::string keep;  // a folder for the files that failed; "": none are kept
  Limits limits;
};

struct Cell {
  std::size_t refused = 0;
  std::size_t unchanged = 0;  // accepted, and what was read is what the undamaged file holds
  std::size_t changed = 0;    // accepted as something else
  bool promised = false;      // mustBeSeen()
};

struct Result {
  std::vector<std::string> formats;  // in order
  std::map<std::pair<std::string, Damage>, Cell> cells;
  std::vector<std::string> failures;  // a line each: format, damage, number, what happened
  std::size_t files = 0;
  double most_seconds = 0;
  std::size_t most_memory_bytes = 0;
};

// `progress` is called after each file. Throws std::runtime_error where a file that is not damaged cannot be read.
[[nodiscard]] Result run(const Plan& plan, const std::function<void(std::size_t files)>& progress = nullptr);

// Formats against kinds of damage, as docs/volumes.md has it.
[[nodiscard]] std::string table(const Result& result);

}  // namespace palpate::damage
