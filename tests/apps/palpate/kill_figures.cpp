// SPDX-License-Identifier: Apache-2.0
#include "kill_figures.hpp"

#include <fmt/format.h>

#include "apps/bench/bench_result.hpp"
#include "base/atomic_file.hpp"

namespace palpate {
namespace {

constexpr const char* kIntroduction = R"(
Editing sessions are killed (`kill -9`) at random moments, from a twentieth to nineteen twentieths of their time.
`touch`: the tool drills, every other time in real time.
`touch --save-every`: the same, its volume saved ten times a second of the session's clock.
`edit`: `palpate edit` with a script of 3000 commands, every kind of edit, stamps, undo and redo.
After each kill `palpate recover` makes the volume from the journal; a slow, obvious twin applies the journal's edits
to the whole volume, and both must be equal, bit for bit.
A file that was saved before the kill must be the volume after one of the session's edits, bit for bit.
A record is acknowledged when the disk has confirmed it; `recovered` counts those too that had reached the file
without being confirmed yet, `torn` journals whose last record was cut short.
A session that was killed before its journal was there has nothing to recover.)";

std::string tableOf(const std::vector<KillFigures>& kinds) {
  std::string text =
      fmt::format("{:20}{:>7}{:>14}{:>14}{:>12}{:>11}{:>9}{:>6}{:>9}{:>9}\n", "session", "kills", "with records",
                  "acknowledged", "at most", "recovered", "missing", "torn", "volumes", "saves");
  text += fmt::format("{:20}{:>7}{:>14}{:>14}{:>12}{:>11}{:>9}{:>6}{:>9}{:>9}\n", "", "", "", "records", "of all",
                      "records", "records", "", "as twin", "whole");
  for (const KillFigures& k : kinds) {
    text += fmt::format("{:20}{:>7}{:>14}{:>14}{:>12}{:>11}{:>9}{:>6}{:>9}{:>9}\n", k.kind, k.kills, k.with_records,
                        k.acknowledged, fmt::format("{}/{}", k.most_acknowledged, k.records_in_all), k.recovered,
                        k.missing, k.torn, fmt::format("{}/{}", k.volumes - k.other_volumes, k.volumes),
                        k.saves == 0 ? "-" : fmt::format("{}/{}", k.saves - k.other_saves, k.saves));
  }
  return text;
}

}  // namespace

void writeKillFigures(const std::vector<KillFigures>& kinds, const std::string& command, const std::string& commit,
                      const std::string& vulkan_device, double seconds, const std::filesystem::path& folder) {
  BenchResult result{.bench = "kills",
                     .commit = commit,
                     .machine = machineInWords(),
                     .vulkan_device = vulkan_device,
                     .command = command,
                     .rows = {},
                     .targets = {}};
  KillFigures sum;
  for (const KillFigures& k : kinds) {
    sum.kills += k.kills;
    sum.missing += k.missing;
    sum.other_volumes += k.other_volumes;
    sum.other_saves += k.other_saves;
    result.rows.push_back({{"part", "session"},
                           {"kind", k.kind},
                           {"records_in_all", static_cast<std::int64_t>(k.records_in_all)},
                           {"kills", k.kills},
                           {"with_acknowledged_records", k.with_records},
                           {"acknowledged_records", static_cast<std::int64_t>(k.acknowledged)},
                           {"most_acknowledged_records", static_cast<std::int64_t>(k.most_acknowledged)},
                           {"recovered_records", static_cast<std::int64_t>(k.recovered)},
                           {"missing_records", static_cast<std::int64_t>(k.missing)},
                           {"torn_journals", k.torn},
                           {"recovered_volumes", k.volumes},
                           {"volumes_unlike_the_twins", k.other_volumes},
                           {"saved_files", k.saves},
                           {"saved_files_not_whole", k.other_saves}});
  }
  result.rows.push_back({{"part", "all"}, {"kills", sum.kills}, {"time_s", seconds}});
  const auto none = [&](const char* name, double value) { result.targets.push_back({name, value, 0}); };
  none("acknowledged records that are missing", static_cast<double>(sum.missing));
  none("recovered volumes that differ from the twin's", sum.other_volumes);
  none("files saved before the kill that are not whole", sum.other_saves);
  writeFileAtomically(folder / "kills.json", jsonText(result));
  writeFileAtomically(folder / "kills.md", benchPage(result, {.title = "What a kill costs",
                                                              .introduction = asParagraph(kIntroduction),
                                                              .tables = tableOf(kinds),
                                                              .chart = {}}));
}

}  // namespace palpate
