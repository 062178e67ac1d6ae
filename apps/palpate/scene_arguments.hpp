// SPDX-License-Identifier: Apache-2.0
// apps/palpate/scene_arguments.hpp: the scene on a command line: VOLUME or SCENE.toml, and a flag for every key.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/plan/scene.hpp"

namespace palpate {

// Quotes what a shell would take apart.
[[nodiscard]] std::string shellWord(const std::string& word);

// A name like this one that nothing has: "kept" gives "kept-2", and "kept-3" where that is there too.
[[nodiscard]] std::string nextFreeName(const std::string& name);

class SceneArguments {
 public:
  // Adds the positional argument and all scene flags to the verb. This object must outlive the parsing.
  explicit SceneArguments(CLI::App& verb);

  // Defaults, then the scene file, then flags. Throws Error for values that do not fit and where no volume is named.
  [[nodiscard]] Scene scene() const;

  // The scene's flags that the command line has, without their values.
  [[nodiscard]] std::vector<std::string> givenFlags() const;

  // A line that repeats the run: the verb, the positional argument and the flags as given, but for a journal another
  // folder, as the run's own holds its edits then.
  [[nodiscard]] std::string commandLine(const std::string& verb, const Scene& scene) const;

 private:
  std::string source_;               // volume, or scene file if it ends in .toml
  std::vector<std::string> values_;  // by row of the option table; what was given
  std::vector<CLI::Option*> options_;
  std::vector<std::string> objects_;  // --object, as given
};

}  // namespace palpate
