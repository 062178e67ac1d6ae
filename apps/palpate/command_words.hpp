// SPDX-License-Identifier: Apache-2.0
// apps/palpate/command_words.hpp: words of a command line that the program does not know, and what was meant by them.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace palpate {

// The verb of this name under another one. `command`: the words that lead there, "palpate bench". Throws
// Error(kBadInput), with the verb that was meant.
[[nodiscard]] const CLI::App& verbNamed(const CLI::App& above, const std::string& name, const std::string& command);

// Every flag that a verb takes: "--out", "-o".
[[nodiscard]] std::vector<std::string> flagsOf(const CLI::App& verb);
[[nodiscard]] std::vector<std::string> verbsOf(const CLI::App& above);

// One line, without "palpate: ", for what CLI11 could not parse: in the order in which it was given, with the flag that
// was meant.
[[nodiscard]] std::string parseMessage(const CLI::App& verb, const std::string& command, const CLI::ParseError& error);

}  // namespace palpate
