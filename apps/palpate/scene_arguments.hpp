// SPDX-License-Identifier: Apache-2.0
// apps/palpate/scene_arguments.hpp: a scene from the command line: VOLUME or SCENE.toml, and a flag for every key.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/scene/scene.hpp"

namespace palpate {

// The first of NAME-2, NAME-3, ... that does not exist as a file or folder; for "kept-2" the series goes on at
// "kept-3".
[[nodiscard]] std::string nextFreeName(const std::string& name);

class SceneArguments {
 public:
  // Adds the positional argument and the scene's flags to the verb: a run's, or a service's, which are more. This
  // object must outlive parsing.
  enum class Of { kRun, kService };
  explicit SceneArguments(CLI::App& verb, Of of = Of::kRun);

  // Defaults, overridden by the scene file, overridden by flags. Throws Error for invalid values and if no volume is
  // named.
  [[nodiscard]] Scene scene() const;

  // The volume or scene file, as given; empty if only --volume names it.
  [[nodiscard]] const std::string& source() const noexcept { return source_; }

  // Throws Error(kBadInput) for an output that is a file which the scene is made of: volume, scene file, path, mesh of
  // an object. An empty name is no output.
  void checkNotRead(const Scene& scene, const std::string& output) const;

  // The scene flags on the command line, without their values.
  [[nodiscard]] std::vector<std::string> givenFlags() const;

  // A line that repeats the run: the verb, the positional argument and the flags as given. Only the journal gets
  // another folder, since the given one then holds this run's edits.
  [[nodiscard]] std::string commandLine(const std::string& verb, const Scene& scene) const;

 private:
  [[nodiscard]] bool isGiven(std::size_t row) const { return options_[row] != nullptr && options_[row]->count() > 0; }

  std::string source_;                 // volume, or scene file if it ends in .toml
  std::vector<std::string> values_;    // as given, by row of the option table
  std::vector<CLI::Option*> options_;  // null: no flag of this verb
  std::vector<std::string> objects_;   // --object, as given
};

}  // namespace palpate
