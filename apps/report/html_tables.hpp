// SPDX-License-Identifier: Apache-2.0
// apps/report/html_tables.hpp: the sections of report.html that are tables and lists, each a piece of HTML.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "apps/report/touch_run.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {

[[nodiscard]] std::string keyFigures(const TouchRun& run, const RunFigures& figures);
[[nodiscard]] std::string faultSection(const TouchRun& run);
[[nodiscard]] std::string editSection(const TouchRun& run);  // empty for a run without edits
[[nodiscard]] std::string workSection(const TouchRun& run);  // stages and memory
[[nodiscard]] std::string planSection(const TouchRun& run);
[[nodiscard]] std::string machineSection(const TouchRun& run);
[[nodiscard]] std::string parameterSection(const TouchRun& run, const nlohmann::ordered_json& summary);
[[nodiscard]] std::string repeatSection(const TouchRun& run);

}  // namespace palpate
