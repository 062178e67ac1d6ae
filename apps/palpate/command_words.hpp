// SPDX-License-Identifier: Apache-2.0
// apps/palpate/command_words.hpp: messages for words of a command line that the program does not know, with the nearest
// word that it knows.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace palpate {

// The verb `name` below the verb `above`. `command`: the words that lead to `above`, "palpate bench". Throws
// Error(kBadInput) for an unknown name, with the nearest verb.
[[nodiscard]] const CLI::App& verbNamed(const CLI::App& above, const std::string& name, const std::string& command);

// Every flag that a verb takes: "--out", "-o".
[[nodiscard]] std::vector<std::string> flagsOf(const CLI::App& verb);
[[nodiscard]] std::vector<std::string> verbsOf(const CLI::App& above);

// One line, without "palpate: ", for what CLI11 could not parse: the unknown words in the order in which they were
// given, with the nearest flag.
[[nodiscard]] std::string parseMessage(const CLI::App& verb, const std::string& command, const CLI::ParseError& error);

}  // namespace palpate
