// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/served_engine.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/convert/convert_job.hpp"
#include "apps/held/held_device.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/option_table.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/touch/scene_plan.hpp"
#include "base/error.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

// Options of a run that has an end, by their keys.
struct OfARun {
  const char* key;
  const char* reason;
  const char* remedy;
};
constexpr OfARun kOfARun[] = {
    {"servo.clock", "a service runs by the real clock", "leave it out, or take 'palpate touch'"},
    {"servo.service", "a service's servo is in a process of its own already", "leave it out"},
    {"device.recording", "a service plays no recording back", "take 'palpate touch' for that"},
    {"device.record", "a service keeps no recording", "take 'palpate touch' for that"},
    {"edit.brush", "a service edits what its clients ask for", "leave it out, and take 'palpate ctl edit'"},
    {"edit.save_every_s", "a service keeps every edit in its journal, and saves when it ends",
     "leave it out, and take 'palpate ctl save'"},
    {"output.folder", "a service writes no report", "leave it out, or take 'palpate touch'"},
    {"output.trace", "a service writes no trace", "leave it out, or take 'palpate touch'"},
    {"output.stopped_trace_ticks", "a service writes no trace", "leave it out, or take 'palpate touch'"},
    {"output.picture", "a service draws when a client asks", "leave it out, and take 'palpate ctl render'"},
    {"output.width", "a service draws when a client asks", "leave it out, and take 'palpate ctl render --width'"},
    {"output.height", "a service draws when a client asks", "leave it out, and take 'palpate ctl render --height'"},
};

// For a journal that is not this volume's.
std::string remedyFor(const std::filesystem::path& earlier) {
  return fmt::format(
      "edits of an earlier service wait in {0}: serve their volume again, or write them to a file with "
      "'palpate recover {0} --out FILE' and delete that folder, or name another --journal",
      earlier.string());
}

}  // namespace

Plan servedPlan(Scene scene) {
  scene.picture = true;
  EngineRequest request = planFor(scene).request;
  request.edits = request.draws = true;
  request.other_isovalues = !scene.gradient_all && scene.samples != "half" && scene.field != "distance";
  return makePlan(request);
}

void checkFollowsEdits(const std::string& algorithm, const std::string& input) {
  if (algorithmEntry(algorithm).needs.isosurface_mesh)
    refuse(input, "it touches a mesh, which would not follow the edits", "choose another one, as hri");
}

void checkServable(const Scene& scene) {
  const Scene usual;
  for (const OfARun& one : kOfARun) {
    const SceneOption& option = *optionOfKey(one.key);
    const std::string text = optionText(option.value, scene);
    if (text != optionText(option.value, usual))
      refuse(fmt::format("{} {}", option.flag, text), one.reason, one.remedy);
  }
  if (!hasPath(scene) && !isHeld(scene))
    refuse("--device " + scene.device, "a service plays no recording back", "take 'palpate touch' for that");
  checkFollowsEdits(scene.algorithm, "--algorithm " + scene.algorithm);
  if (!scene.save.empty()) checkOutput({.in = scene.volume, .out = scene.save});
}

ServedEngine::ServedEngine(const Scene& scene, const std::filesystem::path& journal, Progress& progress,
                           const Tell& tell, const LiveVolumeRequest::Look& look)
    : tell_(tell), filter_(scene.filter) {
  journal_.emplace(journal);
  const Plan plan = servedPlan(scene);
  live_.emplace(LiveVolumeRequest{.volume = scene.volume,
                                  .isovalue = scene.isovalue,
                                  .gpu = scene.gpu,
                                  .gpu_memory_bytes = scene.gpu_memory_bytes,
                                  .plan = plan,
                                  .journal = journal,
                                  .recovers = journal_->earlier(),
                                  .recovers_else = remedyFor(journal_->earlier()),
                                  .look =
                                      [&](const Volume& volume, double isovalue) {
                                        unfiltered_scale_ = densityScaleOf(volume, isovalue);
                                        if (look) look(volume, isovalue);
                                      },
                                  .outlives_its_engine = true,
                                  .work = "palpate serve"},
                progress, tell);
  if (live_->journalFailure().empty()) takeOver();
  const Volume& volume = live_->volume();
  size_ = volume.size();
  lattice_ = volume.lattice();
  Engine& engine = live_->engine();
  seen_ = objectExtent(engine.bounds(), BrickGrid{size_, lattice_.spacing_m}, lattice_,
                       static_cast<float>(engine.isovalue()), {}, engine.filters() ? nullptr : &volume);
  noteFelt(plan);
}

void ServedEngine::takeOver() {
  if (const auto aside = journal_->takeOver(live_->loss().empty()); !aside.empty())
    tell_(fmt::format(
        "the journal that could not be read to its end is kept as {}: 'palpate recover {} --out FILE' makes "
        "a volume of what can be read",
        aside.string(), aside.string()));
  journal_counts_ = true;
}

void ServedEngine::lookAfterJournal(std::int64_t now_ns) {
  const JournalWriter* const journal = live_->session().journal();
  if (journal == nullptr) return;
  if (journal->timesMended() != journal_mended_) journal_counts_ = false;  // its folder may have been made again
  journal_mended_ = journal->timesMended();
  if (journal->failed() || journal_counts_ || now_ns < next_take_over_ns_) return;
  constexpr std::int64_t kAgain_ns = 1'000'000'000;
  next_take_over_ns_ = now_ns + kAgain_ns;
  try {
    journal_->lockAgain();
    takeOver();
  } catch (const Error& error) {
    if (std::exchange(told_, error.what()) != error.what())
      tell_(fmt::format("the journal would not count at the next start: {}", error.what()));
  }
}

void ServedEngine::makeAnew(const Scene& scene) {
  const Plan plan = servedPlan(scene);
  live_->makeEngineAnew(plan);
  if (scene.filter != filter_) noteFelt(plan);  // else the same contact is felt on
  filter_ = scene.filter;
}

void ServedEngine::noteFelt(const Plan& plan) {
  Engine& engine = live_->engine();
  scale_ = engine.filters() ? densityScaleOf(engine.filtered(live_->volume().facts()), engine.isovalue())
                            : unfiltered_scale_;
  plan_ = planLines(plan, engine.planFacts());
  can_change_isovalue_ = plan.request.other_isovalues;
  gradient_everywhere_ = engine.gradientEverywhere();
}

}  // namespace palpate
