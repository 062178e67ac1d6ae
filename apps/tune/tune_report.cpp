// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/tune_report.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/report/machine_facts.hpp"
#include "apps/study/pareto_front.hpp"
#include "apps/tune/quantity.hpp"
#include "apps/tune/reasons.hpp"
#include "base/byte_size.hpp"
#include "base/json_text.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBytesPerMiB = 1024.0 * 1024.0;

std::string boundText(const Goal& goal) {
  return goal.kind == Goal::Kind::kError ? forceText(goal.bound) : timeText(goal.bound);
}

std::string choiceWords(const Candidate& candidate) {
  std::vector<std::string> words;
  for (const Axis axis : kAxes) words.push_back(fmt::format("{} {}", axisName(axis), valueOn(axis, candidate)));
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string figureWords(const Trial& trial) {
  return fmt::format("{} N (99 % of ticks), {} us a tick, {}, start {} ms", figureText(trial.error_N),
                     figureText(trial.loop_us), inMiB(trial.memory_bytes), figureText(trial.start_ms));
}

// Whether each trial is on the front of error and time.
std::vector<bool> onFront(const Found& found) {
  std::vector<CostAndError> choices;
  for (const Trial& trial : found.trials) {
    const bool counts = holdsContact(trial, found.base);
    choices.push_back({trial.loop_us, counts ? trial.error_N : std::nan("")});
  }
  std::vector<bool> front(found.trials.size(), false);
  for (const std::size_t i : paretoFront(choices)) front[i] = true;
  return front;
}

bool isNear(const Candidate& a, const Candidate& b) {
  return std::ranges::any_of(kAxes, [&](Axis axis) { return differOnlyOn(axis, a, b); });
}

std::string markOf(const Trial& trial, const TuneResult& result, const Candidate& own, bool front) {
  std::vector<std::string> marks;
  if (trial.candidate == result.chosen.candidate) marks.emplace_back(result.met ? "picked, felt anew" : "nearest");
  if (trial.candidate == own) marks.emplace_back("the scene's");
  if (front) marks.emplace_back("front");
  if (!trial.impossible.empty())
    marks.push_back("cannot be: " + trial.impossible);
  else if (!holdsContact(trial, result.found.base))
    marks.emplace_back("loses the contact");
  return fmt::format("{}", fmt::join(marks, ", "));
}

std::string tableOf(const TuneRequest& request, const TuneResult& result) {
  const std::vector<bool> front = onFront(result.found);
  const Candidate own = candidateOf(request.scene);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < result.found.trials.size(); ++i) {
    const Candidate& candidate = result.found.trials[i].candidate;
    if (front[i] || candidate == own || candidate == result.chosen.candidate ||
        isNear(candidate, result.chosen.candidate))
      rows.push_back(i);
  }
  std::ranges::stable_sort(rows, {}, [&](std::size_t i) { return result.found.trials[i].loop_us; });
  std::string text = fmt::format("  {:<12} {:<20} {:>6} {:>6} {:<7} {:>8} {:>10} {:>9} {:>9}\n", "operator", "filter",
                                 "n", "window", "storage", "error N", "us a tick", "MiB", "start ms");
  for (const std::size_t i : rows) {
    const bool anew = result.met && result.found.trials[i].candidate == result.chosen.candidate;
    const Trial& trial = anew ? result.chosen : result.found.trials[i];
    const Candidate& c = trial.candidate;
    const std::string error = std::isnan(trial.error_N) ? "-" : figureText(trial.error_N);
    text += fmt::format("  {:<12} {:<20} {:>6} {:>6} {:<7} {:>8} {:>10} {:>9} {:>9}  {}\n", c.gradient_operator,
                        valueOn(Axis::kFilter, c), c.n, c.window_edge, c.samples, error, figureText(trial.loop_us),
                        figureText(static_cast<double>(trial.memory_bytes) / kBytesPerMiB), figureText(trial.start_ms),
                        markOf(trial, result, own, front[i]));
  }
  return text;
}

Json candidateJson(const Candidate& c) {
  return {{"gradient_operator", c.gradient_operator},
          {"filter", c.filter},
          {"n_ticks", c.n},
          {"window_voxel", c.window_edge},
          {"samples", c.samples}};
}

Json trialJson(const Trial& trial) {
  Json json = candidateJson(trial.candidate);
  json["force_error_p99_N"] = std::isnan(trial.error_N) ? Json(nullptr) : Json(trial.error_N);
  json["loop_us_a_tick"] = trial.loop_us;
  json["memory_bytes"] = trial.memory_bytes;
  json["start_ms"] = trial.start_ms;
  json["contact_share"] = trial.contact_share;
  json["faulty_ticks"] = trial.faulty_ticks;
  json["impossible"] = trial.impossible.empty() ? Json(nullptr) : Json(trial.impossible);
  return json;
}

}  // namespace

std::string tuneWords(const TuneRequest& request, const TuneResult& result) {
  const Goal& goal = request.goal;
  const char* asked = goal.kind == Goal::Kind::kError ? "--error" : "--budget";
  std::string text = fmt::format("Asked     {} {} of {}\n", asked, boundText(goal), request.source);
  text += fmt::format("Truth     {}\n", result.truth);
  text +=
      fmt::format("Trials    {} in {} runs on {}; error is that of the spring's force, which 99 % of the ticks keep\n",
                  result.found.trials.size(), result.runs, result.device);
  text += tableOf(request, result);
  for (const std::string& note : result.notes) text += fmt::format("Note      {}\n", note);
  if (!result.met) {
    const std::string who =
        result.felt_anew.empty() ? "no candidate" : fmt::format("none of the {} felt anew", result.felt_anew.size());
    text += fmt::format("Cannot    {} keeps {} {}; the nearest: {}\n", who, asked, boundText(goal),
                        choiceWords(result.chosen.candidate));
    text += fmt::format("Nearest   {}\nNeeded    {}\n", figureWords(result.chosen), result.needed);
    return text;
  }
  text += fmt::format("Picked    {}\n", choiceWords(result.chosen.candidate));
  for (const Reason& reason : result.reasons)
    text += fmt::format("          {} {}: {}\n", reason.choice, reason.value, reason.why);
  if (result.found.as_good > 1) {
    text += fmt::format(
        "Equal     {} choices do as well but for chance; of these one was picked that changes fewest settings\n",
        result.found.as_good);
  }
  const std::string how = result.felt_how.empty() ? "" : result.felt_how + ", ";
  text += fmt::format("Met       {}in fresh runs {}\nScene     {}\n", how, figureWords(result.chosen), result.out);
  return text;
}

std::string tuneJson(const TuneRequest& request, const TuneResult& result) {
  const std::vector<bool> front = onFront(result.found);
  const MachineFacts machine = readMachineFacts();
  Json json = {
      {"schema", "palpate.tune/1"},
      {"commit", request.commit},
      {"command", request.command},
      {"cpu", machine.cpu},
      {"vulkan_device", result.device},
      {"asked",
       {{request.goal.kind == Goal::Kind::kError ? "force_error_p99_N" : "loop_us_a_tick", request.goal.bound}}},
      {"met", result.met},
      {"base", trialJson(result.found.base)},
      {"felt_how", result.felt_how},
      {"fresh_runs_times_as_long", result.longer},
      {"choices_as_good", result.found.as_good},
      {"chosen", trialJson(result.chosen)},
      {"scene", result.met ? Json(result.out) : Json(nullptr)},
      {"needed", result.met ? Json(nullptr) : Json(result.needed)},
      {"truth", result.truth},
      {"notes", result.notes},
      {"reasons", Json::array()},
      {"felt_anew", Json::array()},
      {"trials", Json::array()}};
  for (const Reason& reason : result.reasons)
    json["reasons"].push_back({{"choice", reason.choice}, {"value", reason.value}, {"why", reason.why}});
  for (const Trial& trial : result.felt_anew) json["felt_anew"].push_back(trialJson(trial));
  for (std::size_t i = 0; i < result.found.trials.size(); ++i) {
    json["trials"].push_back(trialJson(result.found.trials[i]));
    json["trials"].back()["front"] = static_cast<bool>(front[i]);
  }
  return jsonFileText(json);
}

}  // namespace palpate
