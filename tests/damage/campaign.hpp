// SPDX-License-Identifier: Apache-2.0
// tests/damage/campaign.hpp: damages many files, reads them and counts what happened. Thread: as judge().
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
  std::size_t per_cell = 10;  // files for each format and kind of damage; more if values are text
  std::size_t many = 0;       // files for each format with several kinds of damage at once
  std::uint64_t seed = 1;
  std::string only;  // only formats whose names contain this; "": all
  std::string keep;  // folder for the files that failed; "": none is kept
  Limits limits;
};

// Results for one format and one kind of damage.
struct Cell {
  std::size_t refused = 0;
  std::size_t unchanged = 0;  // accepted, with the content of the undamaged file
  std::size_t changed = 0;    // accepted, with another content
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

// `progress` is called after each file. Throws std::runtime_error if an undamaged file cannot be read.
[[nodiscard]] Result run(const Plan& plan, const std::function<void(std::size_t files)>& progress = nullptr);

// A table of formats against kinds of damage, as in docs/volumes.md.
[[nodiscard]] std::string table(const Result& result);

}  // namespace palpate::damage
