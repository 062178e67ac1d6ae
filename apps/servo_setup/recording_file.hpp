// SPDX-License-Identifier: Apache-2.0
// apps/servo_setup/recording_file.hpp: recordings of devices as files (docs/recording.md). Set-up code; any thread.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/scene/scene.hpp"
#include "servo/devices/recording.hpp"

namespace palpate {

inline constexpr const char* kRecorded = "recorded";  // the device that plays one (servo/devices/registry.hpp)

// Throws Error: kNotFound for a file that cannot be opened; kBadInput as readRecording() does, and without a name.
[[nodiscard]] std::shared_ptr<const Recording> loadRecording(const std::string& file);

// What is wrong with the scene's recording, and what of it is played; empty: nothing, or it has none. Throws as above.
[[nodiscard]] std::optional<std::string> noteOnRecording(const Scene& scene);

// How long the scene's recording is [s]. Throws as above.
[[nodiscard]] double recordedDuration_s(const Scene& scene);

// Before a run: throws Error(kIo) where no file can be written, and kBadInput if there is one that is no recording.
void checkRecordable(const std::string& file);
// Whole or not at all. Throws Error(kIo).
void saveRecording(const std::string& file, const Recording& recording);

}  // namespace palpate
