// SPDX-License-Identifier: Apache-2.0
// apps/palpate/program.hpp: a program with verbs: runs the one that was asked for and reports what it throws.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

// To be returned by main(). What a verb throws becomes one line on stderr and an exit status (docs/command-line.md).
[[nodiscard]] int runProgram(int argc, char** argv, void (*addVerbs)(CLI::App&));

}  // namespace palpate
