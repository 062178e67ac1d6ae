// SPDX-License-Identifier: Apache-2.0
// apps/report/summary.hpp: summary.json, the run for other programs. Every key, its unit and meaning: docs/summary.md.
#pragma once

#include <filesystem>
#include <string_view>

#include <nlohmann/json.hpp>

#include "apps/report/touch_run.hpp"

namespace palpate {

inline constexpr std::string_view kSummaryName = "palpate.touch.summary/";  // of every version
inline constexpr std::string_view kSummarySchema = "palpate.touch.summary/2";

// Any thread. Cost: that of computeFigures. NaN and infinity become null.
[[nodiscard]] nlohmann::ordered_json makeSummary(const TouchRun& run);

// Indented, one newline at the end. Throws Error kIo (atomic_file.hpp).
void writeSummary(const std::filesystem::path& file, const TouchRun& run);

}  // namespace palpate
