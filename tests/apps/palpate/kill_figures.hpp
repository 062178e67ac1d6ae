// SPDX-License-Identifier: Apache-2.0
// What the kill test counted, as a page and as JSON: docs/results/kills.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

struct KillFigures {
  std::string kind;
  std::uint64_t records_in_all = 0;     // of the session where nobody kills it
  int kills = 0;                        // sessions that ended by it
  int with_records = 0;                 // of those, with acknowledged records
  std::uint64_t acknowledged = 0;       // records, in all sessions together
  std::uint64_t most_acknowledged = 0;  // in one
  std::uint64_t recovered = 0;          // records
  std::uint64_t missing = 0;            // acknowledged and not recovered
  int torn = 0;                         // journals whose last record was cut short
  int volumes = 0;                      // recovered: as many as had a journal
  int other_volumes = 0;                // of those, that are not what the twin makes
  int saves = 0;                        // sessions that had saved their volume before
  int other_saves = 0;                  // of those, files that are none of the session's volumes
};

// Writes kills.json and kills.md into the folder.
void writeKillFigures(const std::vector<KillFigures>& kinds, const std::string& command, const std::string& commit,
                      const std::string& vulkan_device, double seconds, const std::filesystem::path& folder);

}  // namespace palpate
