// SPDX-License-Identifier: Apache-2.0
// base/measured.hpp: times and memory sizes that a piece of work reports of itself, for summaries and reports.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

struct StageTime {
  std::string name;
  double seconds = 0;  // wall time [s]
};

struct MemoryFigure {
  std::string name;
  std::uint64_t bytes = 0;  // [byte]
};

}  // namespace palpate
