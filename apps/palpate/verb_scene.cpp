// SPDX-License-Identifier: Apache-2.0
// palpate scene: every key of a scene file, as docs/scene.md has it.
#include <fmt/format.h>

#include "apps/console/document.hpp"
#include "apps/scene/option_table.hpp"
#include "verbs.hpp"

namespace palpate {

void addSceneVerb(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("scene", "print every key of a scene file with its flag, unit, range and default");
  verb->callback([] { printDocument(sceneDocument()); });
}

}  // namespace palpate
