// SPDX-License-Identifier: Apache-2.0
// apps/palpate/volume_options.hpp: the options --series and --nan of the verbs that take a volume. Set-up thread.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

// Adds both options. Before the verb runs, the values given are added to the name in `volume` (withSeries, withNan),
// which must outlive the verb.
void addVolumeOptions(CLI::App& verb, std::string& volume);

}  // namespace palpate
