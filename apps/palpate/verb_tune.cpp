// SPDX-License-Identifier: Apache-2.0
// palpate tune VOLUME|SCENE: the settings with which a scene keeps an error or a budget.
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/scene/flag_errors.hpp"
#include "apps/scene/scene_command.hpp"
#include "apps/tune/quantity.hpp"
#include "apps/tune/tune_job.hpp"
#include "apps/tune/tune_report.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

struct TuneArguments {
  explicit TuneArguments(CLI::App& verb) : scene(verb) {}
  SceneArguments scene;
  std::string error, budget, out, json;
  bool overwrite = false;
};

Goal goalOf(const TuneArguments& arguments) {
  if (arguments.error.empty() == arguments.budget.empty()) {
    refuse(arguments.error.empty() ? "palpate tune" : "--error and --budget",
           arguments.error.empty() ? "nothing is asked for" : "both are given",
           "give one of them, as --error 0.05N or --budget 200us");
  }
  if (!arguments.error.empty()) return {Goal::Kind::kError, forceOf_N(arguments.error, "--error")};
  return {Goal::Kind::kBudget, timeOf_us(arguments.budget, "--budget")};
}

std::string commandLine(const TuneArguments& arguments, const Scene& scene) {
  std::string line = arguments.scene.commandLine("tune", scene);
  if (!arguments.error.empty()) line += " --error " + shellWord(arguments.error);
  if (!arguments.budget.empty()) line += " --budget " + shellWord(arguments.budget);
  if (!arguments.out.empty()) line += " -o " + shellWord(arguments.out);
  return line;
}

void tuneScene(const TuneArguments& arguments) {
  TuneRequest request;
  request.goal = goalOf(arguments);
  request.out = arguments.out;
  request.overwrite = arguments.overwrite;
  request.json = arguments.json;
  request.commit = programCommit();
  request.scene = arguments.scene.scene();
  for (const std::string& output : {request.out, request.json}) arguments.scene.checkNotRead(request.scene, output);
  request.source = arguments.scene.source().empty() ? request.scene.volume : arguments.scene.source();
  request.command = commandLine(arguments, request.scene);
  Progress progress;
  try {
    const TuneResult result = tune(request, progress);
    printText(tuneWords(request, result));
    if (!result.met) throw CLI::RuntimeError(1);
  } catch (const Error& error) {
    throw withFlag(error);
  }
}

}  // namespace

void addTuneVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("tune", "choose a scene's settings for an error of the force or a time a tick");
  verb->footer(
      "Picks gradient operator, filter, n, window and storage, says why, and writes the scene.\n"
      "Example: palpate tune scene.toml --error 0.05N");
  auto arguments = std::make_shared<TuneArguments>(*verb);
  verb->add_option("--error", arguments->error,
                   "the most that the spring's force may be off, in 99 % of the ticks: 0.05N")
      ->type_name("FORCE")
      ->check(notEmpty);
  verb->add_option("--budget", arguments->budget,
                   "the mean time that a tick may take by the simulated clock, windows included: 200us")
      ->type_name("TIME")
      ->check(notEmpty);
  verb->add_option("-o,--write", arguments->out,
                   "the scene; NAME.tuned.toml beside NAME.toml, or tuned.toml, if not given")
      ->type_name("FILE")
      ->check(notEmpty);
  verb->add_flag("--overwrite", arguments->overwrite,
                 "also a file that palpate tune did not write, or that was edited since");
  verb->add_option("--json", arguments->json, "file for every trial")->type_name("FILE")->check(notEmpty);
  verb->callback([arguments] { tuneScene(*arguments); });
}

}  // namespace palpate
