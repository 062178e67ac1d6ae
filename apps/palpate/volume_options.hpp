// SPDX-License-Identifier: Apache-2.0
// apps/palpate/volume_options.hpp: --series and --nan of the verbs that take a volume. Set-up thread.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

// Where they are given, `volume`, which outlives the verb, is named by them before the verb runs (withSeries, withNan).
void addVolumeOptions(CLI::App& verb, std::string& volume);

}  // namespace palpate
