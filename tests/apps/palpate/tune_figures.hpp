// SPDX-License-Identifier: Apache-2.0
// What `palpate tune` made of random scenes, as a page: docs/results/tune.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

struct TunedScene {
  std::uint64_t seed = 0;
  std::string scene;    // volume and what else is not usual, in words
  bool error = false;   // what is asked for: an error, else a budget
  double bound = 0;     // [N] or [us]
  bool met = false;     // else: cannot
  double figure = 0;    // as `palpate tune` tells it, of its fresh runs or of the nearest [N] or [us]
  double fresh = -1;    // met: of one more run, by `palpate touch`; -1: it knows none [N] or [us]
  std::string choice;   // operator, filter, n, window, storage
  bool within = true;   // met: the fresh figure is within the bound
  bool denied = false;  // cannot: a trial, or the scene as it is, keeps the goal all the same
  double seconds = 0;   // that `palpate tune` took
};

// Writes tune.md into the folder.
void writeTuneFigures(const std::vector<TunedScene>& scenes, const std::string& command, const std::string& commit,
                      const std::string& vulkan_device, const std::filesystem::path& folder);

}  // namespace palpate
