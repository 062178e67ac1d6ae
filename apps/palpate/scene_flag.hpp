// SPDX-License-Identifier: Apache-2.0
// apps/palpate/scene_flag.hpp: the flag of a scene's option on the command line of a verb.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/scene/option_table.hpp"

namespace palpate {

// Its value goes to `value`, as text; a flag without a value gets the word that it stands for.
// `usual`: a scene in which nothing was set.
CLI::Option* addSceneFlag(CLI::App& verb, const SceneOption& option, std::string& value, const Scene& usual = {});

// The flags of some options of a scene, by their keys, for a verb that reads no others. Must outlive parsing.
class SceneFlags {
 public:
  SceneFlags(CLI::App& verb, std::span<const char* const> keys, const Scene& usual);
  // Sets what was given. Throws Error(kBadInput) for an invalid value.
  void apply(Scene& scene) const;
  [[nodiscard]] std::vector<std::string> given() const;  // without their values

 private:
  struct Flag {
    const SceneOption* option;
    std::string value;
    CLI::Option* given;
  };
  std::vector<Flag> flags_;
};

}  // namespace palpate
