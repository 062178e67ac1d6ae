// SPDX-License-Identifier: Apache-2.0
// apps/report/page_files.hpp: the texts that CMake builds into the program for report.html. Any thread, no cost.
#pragma once

#include <string_view>

namespace palpate {

extern const std::string_view kDygraphsJs;  // the plotting library, from Debian's libjs-dygraphs (MIT licence)
extern const std::string_view kDygraphsCss;
extern const std::string_view kReportJs;   // page/report.js: draws the plots from the page's data
extern const std::string_view kReportCss;  // page/report.css

}  // namespace palpate
