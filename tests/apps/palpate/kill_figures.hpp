// SPDX-License-Identifier: Apache-2.0
// The counts of the kill test, as a page and as JSON: docs/results/kills.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

struct KillFigures {
  std::string kind;
  std::uint64_t records_in_all = 0;     // records of a session that is not killed
  int kills = 0;                        // sessions that were killed
  int with_records = 0;                 // killed sessions with acknowledged records
  std::uint64_t acknowledged = 0;       // acknowledged records of all killed sessions
  std::uint64_t most_acknowledged = 0;  // acknowledged records of one session, at most
  std::uint64_t recovered = 0;          // recovered records
  std::uint64_t missing = 0;            // acknowledged records that were not recovered
  int torn = 0;                         // journals whose last record was cut short
  int volumes = 0;                      // recovered volumes: one for each journal
  int other_volumes = 0;                // recovered volumes that differ from the twin's
  int saves = 0;                        // sessions that had saved their volume before the kill
  int other_saves = 0;                  // saved files that are none of the session's volumes
};

// Writes kills.json and kills.md into the folder.
void writeKillFigures(const std::vector<KillFigures>& kinds, const std::string& command, const std::string& commit,
                      const std::string& vulkan_device, double seconds, const std::filesystem::path& folder);

}  // namespace palpate
