// SPDX-License-Identifier: Apache-2.0
// palpate touch VOLUME|SCENE: the main job.
#include <optional>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/report/words.hpp"
#include "apps/scene/flag_errors.hpp"
#include "apps/scene/idle_options.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/touch/touch_job.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {

namespace {

// The run was written. The exit status tells whether all of it was.
void endWith(const TouchRun& run) {
  const bool lost = run.edits && lostEdits(*run.edits);
  if (run.ended_early.empty() && !lost) return;
  const std::string edits = run.edits ? keptEdits(run.scene, *run.edits) : "";
  const Error stopped(Error::Code::kCancelled, "palpate touch", run.ended_early,
                      fmt::format("what was felt is in {}{}{}; start it again for the rest", run.scene.out,
                                  edits.empty() ? "" : ", ", edits));
  if (!lost) throw stopped;
  if (!run.ended_early.empty()) tellUser(stopped.what());
  throw CLI::RuntimeError(exitStatus(Error::Code::kIo));  // each loss was reported when it happened
}

}  // namespace

void addTouchVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("touch", "palpate a volume along a path and report how it felt");
  verb->footer(
      "Writes trace.csv, summary.json, report.html and view.png into --out. World: LPS, metres.\n"
      "Example: palpate touch 'phantom:knot?size=64' --hand spring --seconds 3 --out knot");
  auto arguments = std::make_shared<SceneArguments>(*verb);
  verb->callback([arguments] {
    Progress progress;
    const Scene scene = arguments->scene();
    arguments->checkNotRead(scene, scene.record);
    for (const std::string& idle : idleOptions(scene, arguments->givenFlags())) tellUser(idle);
    std::optional<KeptWork> telling;  // outlives the run, whose memory may take long to free
    try {
      const TouchRun run = runTouchJob(scene, arguments->commandLine("touch", scene), programCommit(), progress);
      telling.emplace();
      printText(closingSummary(run));
      endWith(run);
    } catch (const Error& error) {
      throw withFlag(error);
    }
  });
}

}  // namespace palpate
