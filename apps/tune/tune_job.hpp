// SPDX-License-Identifier: Apache-2.0
// apps/tune/tune_job.hpp: `palpate tune`: finds the settings with which a scene keeps an error or a budget, confirms
// them in fresh runs, and writes the scene.
#pragma once

#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/scene/scene.hpp"
#include "apps/tune/search.hpp"

namespace palpate {

struct TuneRequest {
  Scene scene;
  std::string source;  // the scene's file or the volume, as given
  Goal goal;
  std::string out;         // the scene that is written; empty: tunedName()
  bool overwrite = false;  // also a file that is not by `palpate tune`
  std::string json;        // empty: none
  std::string command, commit;
};

struct Reason {
  std::string choice, value, why;
};

struct TuneResult {
  Found found;
  bool met = false;
  Trial chosen;                       // met: as it was felt in fresh runs; otherwise what came nearest
  std::vector<Trial> felt_anew = {};  // picks, as they were felt in fresh runs; met: the last is `chosen`
  double longer = 1;                  // how many times as long as in trials fresh runs took, at most [-]
  std::string felt_how;               // "without its brush, with the simulated device"; empty: as the scene says
  std::size_t runs = 0;               // that the trials took, fresh ones not counted
  std::string truth;                  // what the error is taken against, and why, in words
  std::vector<std::string> notes;
  std::vector<Reason> reasons;  // met: for each choice
  std::string needed;           // not met: what would help
  std::string device;           // Vulkan's
  std::string out;              // met: the file that was written
};

// "head.tuned.toml" beside a scene's file "head.toml"; "tuned.toml" for a volume.
[[nodiscard]] std::string tunedName(const std::string& source);

// Writes the scene if the goal is met, and the JSON in any case. Throws Error: as `palpate touch` does; kBadInput for
// an algorithm without a surface, a path without contact, a budget for a tool that edits, a name that a scene cannot
// hold, and an `out` that is there and not by `palpate tune`; kIo.
[[nodiscard]] TuneResult tune(const TuneRequest& request, Progress& progress);

}  // namespace palpate
