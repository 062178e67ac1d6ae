// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/stiff_rows.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/stability/stiff_trial.hpp"
#include "apps/stability/z_width.hpp"
#include "base/quantile.hpp"

namespace palpate {
namespace {

struct StiffRow {
  StiffTrial trial;
  Expected expected = Expected::kBorder;
  StiffOutcome outcome;
};

// A tool that leaves a wall of too much damping alone within some micrometres is no trouble, although the linear loop
// grows: the wall never pulls.
bool shakes(const StiffRow& row) {
  return row.outcome.end_swing_m > std::max(kQuiet_m, kQuietSteps * row.trial.resolution_m);
}

const Columns<StiffRow>& stiffColumns() {
  using R = StiffRow;
  const auto flag = [](bool value) { return static_cast<std::int64_t>(value ? 1 : 0); };
  static const Columns<R> kColumns = {
      {"stiffness_N_per_m", [](const R& r) { return r.trial.wall.stiffness_N_per_m; }},
      {"damping_Ns_per_m", [](const R& r) { return r.trial.wall.damping_Ns_per_m; }},
      {"rate_hz", [](const R& r) { return r.trial.loop.rate_hz; }},
      {"delay_ticks", [](const R& r) { return std::int64_t{r.trial.loop.delay_ticks}; }},
      {"device_mass_kg", [](const R& r) { return r.trial.loop.hand.device_mass_kg; }},
      {"device_damping_Ns_per_m", [](const R& r) { return r.trial.loop.hand.device_damping_Ns_per_m; }},
      {"hand_mass_kg", [](const R& r) { return r.trial.loop.hand.hand_mass_kg; }},
      {"hand_damping_Ns_per_m", [](const R& r) { return r.trial.loop.hand.hand_damping_Ns_per_m; }},
      {"hand_stiffness_N_per_m", [](const R& r) { return r.trial.loop.hand.hand_stiffness_N_per_m; }},
      {"encoder_resolution_m", [](const R& r) { return r.trial.resolution_m; }},
      {"press_m", [](const R& r) { return r.trial.press_m; }},
      {"expected", [](const R& r) { return std::string(name(r.expected)); }},
      {"noticed", [flag](const R& r) { return flag(r.outcome.noticed); }},
      {"notice_s", [](const R& r) { return r.outcome.notice_s; }},
      {"notice_ticks", [](const R& r) { return r.outcome.notice_s * r.trial.loop.rate_hz; }},
      {"end_force_N", [](const R& r) { return r.outcome.end_force_N; }},
      {"end_swing_m", [](const R& r) { return r.outcome.end_swing_m; }},
      {"force_over_limit", [](const R& r) { return r.outcome.force_share_max; }},
      {"slew_over_limit", [](const R& r) { return r.outcome.slew_share_max; }},
      {"finite", [flag](const R& r) { return flag(r.outcome.finite); }},
      {"limited", [flag](const R& r) { return flag(r.outcome.limited); }},
      {"missed",
       [flag](const R& r) { return flag(r.expected == Expected::kGrows && !r.outcome.noticed && shakes(r)); }},
      {"ended_without_cause",
       [flag](const R& r) {
         return flag(r.expected == Expected::kSettles && r.outcome.noticed && !r.outcome.limited);
       }},
      {"not_quiet", [flag](const R& r) { return flag(r.outcome.noticed && r.outcome.end_force_N > 0); }},
      {"not_finite", [flag](const R& r) { return flag(!r.outcome.finite); }}};
  return kColumns;
}

double meanOf(const std::vector<double>& values) {
  return sumOf(values) / static_cast<double>(values.size());
}

std::vector<double> figuresOf(const BenchRows& rows, const char* key) {
  std::vector<double> values;
  for (const BenchRow* row : rows) values.push_back(figureOf(*row, key));
  return values;
}

}  // namespace

void addStiffRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress) {
  const WallVolume plane(WallVolume::Shape::kPlane);
  for (int i = 0; i < request.stiff_trials; ++i) {
    progress(static_cast<double>(i) / request.stiff_trials);
    StiffRow row;
    row.trial = stiffTrial(request.seed, static_cast<std::uint64_t>(i));
    row.expected = expectedOf(row.trial);
    row.outcome = play(row.trial, plane);
    addFigures(result.rows.emplace_back(BenchRow{{"part", "stiff"}}), stiffColumns(), row);
  }
}

void addStiffTargets(BenchResult& result) {
  const auto count = [&](const char* name, const char* key, const BenchRow& like = {}) {
    promise(result, {.name = name, .bound = 0, .part = "stiff", .like = like, .keys = {key}, .of = sumOf});
  };
  promise(result, {.name = "stiff: contacts that grow, shake to the end and that the servo does not notice, share of "
                           "those that grow [-]",
                   .bound = 0.01,
                   .part = "stiff",
                   .like = {{"expected", "grows"}},
                   .keys = {"missed"},
                   .of = meanOf});
  count("stiff: contacts that settle, within the limits, and that the servo ends", "ended_without_cause");
  count("stiff: contacts that the servo ended and that still have a force at the end", "not_quiet");
  count("stiff: runs with a figure that is not finite", "not_finite");
  promise(result, {.name = "stiff: largest force and largest change over their limits [-]",
                   .bound = 1 + 1e-9,
                   .part = "stiff",
                   .keys = {"force_over_limit", "slew_over_limit"},
                   .of = largestOf});
}

std::string stiffTable(const BenchResult& result) {
  std::string text =
      fmt::format("{:<10}{:>8}{:>10}{:>40}\n", "expected", "trials", "noticed", "noticed after, median / longest");
  for (const Expected expected : {Expected::kSettles, Expected::kBorder, Expected::kGrows}) {
    const BenchRows rows = rowsOf(result, "stiff", {{"expected", name(expected)}});
    const BenchRows noticed = rowsOf(result, "stiff", {{"expected", name(expected)}, {"noticed", std::int64_t{1}}});
    std::string times = "-";
    if (!noticed.empty()) {
      const std::vector<double> seconds = figuresOf(noticed, "notice_s"), ticks = figuresOf(noticed, "notice_ticks");
      times = fmt::format("{:.2f} / {:.2f} s, {:.0f} / {:.0f} ticks", median(seconds), largestOf(seconds),
                          median(ticks), largestOf(ticks));
    }
    text += fmt::format("{:<10}{:>8}{:>10}{:>40}\n", name(expected), rows.size(), noticed.size(), times);
  }
  return text;
}

}  // namespace palpate
