// SPDX-License-Identifier: Apache-2.0
// apps/plan/module_cost.hpp: what it takes to load a part of the program that is in a library of its own
// (base/module.hpp). So a run that leaves it out knows what that saves. Set-up code, one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace palpate {

struct ModuleCost {
  std::string name = {};        // "itk"
  double ms = 0;                // to load it, with what it needs
  std::uint64_t bytes = 0;      // by how much the process grows in main memory [byte]
  std::uint64_t libraries = 0;  // that come with it, itself included
  std::string failure = {};     // why it cannot be loaded; empty: it can
};

// Loads it in a child process and forgets it, twice: the figures are those of the second time, when its files are in
// the system's cache. What two modules share counts in both. Call it while no other thread of this process loads
// libraries, and before this process has loaded the module itself: what is there already costs nothing. Throws Error as
// runInChild() does, and kCancelled.
[[nodiscard]] ModuleCost moduleCost(const std::string& name);

}  // namespace palpate
