// SPDX-License-Identifier: Apache-2.0
// apps/palpate/volume_options.hpp: the options --series, --nan and --resample of the verbs that take a volume. Set-up
// thread.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

// Adds these options. Before the verb runs, what is given is added to the name in `volume` (withSeries, withNan,
// withResample), which must outlive the verb.
void addVolumeOptions(CLI::App& verb, std::string& volume);

}  // namespace palpate
