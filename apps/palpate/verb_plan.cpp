// SPDX-License-Identifier: Apache-2.0
// palpate plan VOLUME|SCENE: which passes a scene needs, what was left out, and what that saves.
#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/touch/scene_plan.hpp"
#include "base/byte_size.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/service/engine.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"

namespace palpate {

void addPlanVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("plan", "say which passes a scene needs, what is left out and what that saves");
  auto arguments = std::make_shared<SceneArguments>(*verb);
  verb->callback([arguments] {
    const Scene scene = arguments->scene();
    Progress progress;
    progress.stage("loading " + scene.volume);
    const Volume volume = loadAndTell(scene.volume, progress);
    checkTouchable(volume);
    const double isovalue = static_cast<float>(scene.isovalue ? *scene.isovalue : defaultIsovalue(volume));
    checkIsovalue(volume, isovalue);
    const Plan plan = planFor(scene);
    progress.stage("computing on Vulkan");
    const Engine engine(volume, plan, isovalue, scene.gpu, 0,
                        passProgress(progress, [] { throwIfInterrupted("palpate plan"); }));
    progress.done();
    printResult("{} at isovalue {:g} on {}\n", scene.volume, isovalue, engine.gpu().name);
    for (const PlanLine& line : scenePlanLines(scene, plan, engine.planFacts())) {
      printResult("  {:<8}  {:<64} {:>10}  {}\n", line.done ? "do" : "leave", line.what,
                  line.saved_bytes > 0 ? "-" + inMiB(line.saved_bytes) : "", line.why);
    }
  });
}

}  // namespace palpate
