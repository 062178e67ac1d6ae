// SPDX-License-Identifier: Apache-2.0
// palpate plan VOLUME|SCENE: what a scene needs and why, what it leaves out, and what that saves.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "apps/console/document.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/console/progress.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/plan/module_cost.hpp"
#include "apps/plan/purposes.hpp"
#include "apps/plan/scene_report.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/touch/scene_plan.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/service/engine.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

constexpr int kMostRounds = 100;

// Before anything else of the program has loaded them.
std::vector<ModuleCost> costsOfModules(Progress& progress) {
  progress.stage("loading each library once");
  std::vector<ModuleCost> costs;
  for (const std::string& name : moduleNames()) costs.push_back(moduleCost(name));
  return costs;
}

SceneReport planned(const Scene& scene, Progress& progress) {
  progress.stage("loading " + scene.volume);
  const Volume volume = loadAndTell(scene.volume, progress);
  checkTouchable(volume);
  const double isovalue = static_cast<float>(scene.isovalue ? *scene.isovalue : defaultIsovalue(volume));
  checkIsovalue(volume, isovalue);
  const Plan plan = planFor(scene);
  progress.stage("computing on Vulkan");
  const Engine engine(volume, plan, isovalue, scene.gpu, scene.gpu_memory_bytes,
                      passProgress(progress, [] { throwIfInterrupted("palpate plan"); }));
  return {.volume = scene.volume,
          .isovalue = isovalue,
          .gpu = engine.gpu().name,
          .lines = scenePlanLines(scene, plan, engine.planFacts()),
          .passes = engine.stages(),
          .effects = contactEffectNames(effectParameters(scene))};
}

// A scene that cannot be touched, since no path is found for example, still has a plan.
void count(SceneReport& report, const Scene& scene, std::optional<int> rounds, Progress& progress) {
  const ScratchFolder folder;
  try {
    report.counted = countScene(scene, rounds, folder.path(), progress);
  } catch (const Error& error) {
    if (error.code() != Error::Code::kBadInput) throw;
    report.not_counted = error.reason();
  }
}

}  // namespace

void addPlanVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("plan", "say what a scene needs and why, what it leaves out and what that saves");
  auto arguments = std::make_shared<SceneArguments>(*verb);
  auto rounds = std::make_shared<std::optional<int>>();
  auto json = std::make_shared<std::string>();
  verb->add_option(
          "--rounds", *rounds,
          "how often the scene is run with and without each feature; 0: it is run once, as it is (default: up to "
          "3, as many as take a minute)")
      ->check(CLI::Range(0, kMostRounds));
  verb->add_option("--json", *json, "write it into this file too")->type_name("FILE");
  verb->callback([arguments, rounds, json] {
    const Scene scene = withRecordedBrush(arguments->scene());
    std::unique_ptr<AtomicFile> file;
    if (!json->empty()) {
      arguments->checkNotRead(scene, *json);
      file = std::make_unique<AtomicFile>(*json);
    }
    Progress progress;
    const std::vector<ModuleCost> modules = costsOfModules(progress);
    SceneReport report = planned(scene, progress);
    report.modules = modules;
    count(report, scene, *rounds, progress);
    progress.done();
    printDocument(reportDocument(report));
    if (file) {
      file->write(reportJson(report));
      file->commit();
    }
  });
}

}  // namespace palpate
