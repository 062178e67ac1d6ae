// SPDX-License-Identifier: Apache-2.0
// base/measured.hpp: a time and a memory size with a name, which the engine measures and reports show.
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
