// SPDX-License-Identifier: Apache-2.0
// apps/scene/option_table.hpp: the table of every option of a scene: flag, TOML key, unit, range, help. The command
// line, the scene file, `--help`, docs/scene.md and summary.json are all made from it. Any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/scene/option_value.hpp"

namespace palpate {

struct SceneOption {
  const char* flag;  // "--stiffness"
  const char* key;   // "servo.stiffness_N_per_m"
  const char* unit;  // as on screens: "N/m"; empty for words and counts without one
  const char* help;
  OptionValue value;
};

[[nodiscard]] std::span<const SceneOption> sceneOptions();

// The row of a key, or null.
[[nodiscard]] const SceneOption* optionOfKey(std::string_view key);

// Of `palpate serve` alone; other verbs have no flag for it, and leave its key in a scene file unheeded.
[[nodiscard]] bool isOfService(const SceneOption& option);

// The heading of the option in --help: one for each table of the scene file.
[[nodiscard]] const char* optionGroup(const SceneOption& option);

// "servo rate [Hz] (a number from 10 to 20000; default 1000; key servo.rate_hz)". `usual`: a scene in which nothing was
// set.
[[nodiscard]] std::string optionHelp(const SceneOption& option, const Scene& usual = {});

// The table of docs/scene.md, as `palpate scene` prints it.
[[nodiscard]] std::string sceneDocument();

}  // namespace palpate
