// SPDX-License-Identifier: Apache-2.0
// The sessions that the kill test kills: the program's arguments, and the files that they name.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

inline constexpr const char* kKilledVolume = "phantom:sphere?size=32";

enum class KillKind {
  kTool,         // `palpate touch`: the tool drills
  kToolAndSave,  // the same, and the volume is saved again and again
  kScript        // `palpate edit`: every kind of edit, stamps, undo and redo, from a script
};
inline constexpr std::array<KillKind, 3> kKillKinds = {KillKind::kTool, KillKind::kToolAndSave, KillKind::kScript};
[[nodiscard]] const char* killName(KillKind kind) noexcept;

// The program's arguments, for a folder that makeReady() has prepared; the journal is "journal" in it. Every run makes
// the same edits, except a tool in real time.
[[nodiscard]] std::vector<std::string> killArguments(KillKind kind, bool real_clock);
inline constexpr const char* kKilledSave = "sculpted.vdb";  // the file that kToolAndSave saves
inline constexpr const char* kKilledResult = "out.vdb";     // the file that kScript writes if it is not killed
// Writes the files that the arguments name into the folder.
void makeReady(KillKind kind, const std::filesystem::path& folder);

}  // namespace palpate
