// SPDX-License-Identifier: Apache-2.0
// The sessions that the kill test kills: what the program is started with, and the files that it needs for it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

inline constexpr const char* kKilledVolume = "phantom:sphere?size=32";

enum class KillKind {
  kTool,         // `palpate touch`: the tool drills
  kToolAndSave,  // the same, its volume saved beside it again and again
  kScript        // `palpate edit`: every kind of edit, stamps, undo and redo, from a script
};
inline constexpr std::array<KillKind, 3> kKillKinds = {KillKind::kTool, KillKind::kToolAndSave, KillKind::kScript};
[[nodiscard]] const char* killName(KillKind kind) noexcept;

// The program's arguments, to be started in a folder that makeReady() has seen; the journal is "journal" in it. Each
// start makes the same edits, but for a tool in real time.
[[nodiscard]] std::vector<std::string> killArguments(KillKind kind, bool real_clock);
inline constexpr const char* kKilledSave = "sculpted.vdb";  // of kToolAndSave
inline constexpr const char* kKilledResult = "out.vdb";     // of kScript, where nobody kills it
void makeReady(KillKind kind, const std::filesystem::path& folder);

}  // namespace palpate
