// SPDX-License-Identifier: Apache-2.0
// palpate touch VOLUME|SCENE: the main job.
#include <fmt/format.h>

#include "apps/console/progress.hpp"
#include "apps/report/words.hpp"
#include "apps/scene/idle_options.hpp"
#include "apps/touch/touch_job.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {

void addTouchVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("touch", "palpate a volume along a path and report how it felt");
  verb->footer(
      "Writes trace.csv, summary.json, report.html and view.png into --out. World: LPS, metres.\n"
      "Example: palpate touch phantom:knot?size=64 --hand spring --seconds 3 --out knot");
  auto arguments = std::make_shared<SceneArguments>(*verb);
  verb->callback([arguments] {
    Progress progress;
    const Scene scene = arguments->scene();
    for (const std::string& idle : idleOptions(scene, arguments->givenFlags()))
      fmt::print(stderr, "palpate: {}\n", idle);
    const TouchRun run = runTouchJob(scene, arguments->commandLine("touch", scene), programCommit(), progress);
    fmt::print("{}", closingSummary(run));
  });
}

}  // namespace palpate
