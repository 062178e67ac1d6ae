// SPDX-License-Identifier: Apache-2.0
// apps/palpate/series_option.hpp: --series of the verbs that take a volume. Set-up thread.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

// Where --series is given, `volume`, which outlives the verb, is named by it before the verb runs (withSeries).
void addSeriesOption(CLI::App& verb, std::string& volume);

}  // namespace palpate
