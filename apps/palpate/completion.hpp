// SPDX-License-Identifier: Apache-2.0
// apps/palpate/completion.hpp: what a shell offers while a command is typed: verbs, flags, and the words that a flag
// takes; file names elsewhere. Made from CLI11's tree of verbs and the table of options, so it knows what the program
// knows.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace palpate {

[[nodiscard]] std::string bashCompletion(const CLI::App& app);
[[nodiscard]] std::string zshCompletion(const CLI::App& app);

}  // namespace palpate
