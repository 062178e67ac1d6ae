// SPDX-License-Identifier: Apache-2.0
// apps/palpate/completion.hpp: completion scripts for shells: they offer verbs, flags and the words that a flag takes,
// and file names elsewhere. They are made from CLI11's tree of verbs and the table of options, so they match the
// program.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

[[nodiscard]] std::string bashCompletion(const CLI::App& app);
[[nodiscard]] std::string zshCompletion(const CLI::App& app);

}  // namespace palpate
