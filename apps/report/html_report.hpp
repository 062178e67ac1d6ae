// SPDX-License-Identifier: Apache-2.0
// apps/report/html_report.hpp: report.html, the run for people: one file that needs nothing but a browser.
//
// Style, script, curves and picture are inside; nothing is fetched. Curves are reduced (plot_data.hpp), so the page
// stays below about 3 MB plus the picture, however long the run was. It needs no script to show curves, tables and
// picture.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/report/touch_run.hpp"

namespace palpate {

// `view_png`: the bytes of view.png; empty: no picture. Any thread. Cost: some passes over the records.
[[nodiscard]] std::string makeReport(const TouchRun& run, std::string_view view_png);

// Throws Error kIo (atomic_file.hpp).
void writeReport(const std::filesystem::path& file, const TouchRun& run, std::string_view view_png);

}  // namespace palpate
