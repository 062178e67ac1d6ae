// SPDX-License-Identifier: Apache-2.0
#include "command_words.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {

std::vector<std::string> verbsOf(const CLI::App& above) {
  std::vector<std::string> names;
  for (const CLI::App* verb : above.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

const CLI::App& verbNamed(const CLI::App& above, const std::string& name, const std::string& command) {
  const auto verbs = above.get_subcommands([&](const CLI::App* verb) { return verb->check_name(name); });
  if (!verbs.empty()) return *verbs.front();
  throw Error(Error::Code::kBadInput, name, "there is no such verb",
              withDidYouMean(name, verbsOf(above), fmt::format("'{} --help' lists them", command)));
}

std::vector<std::string> flagsOf(const CLI::App& verb) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
  }
  return flags;
}

// "--clock: At Most 1 required but received 2", "Could not convert: --iso = foo" in plain words.
std::string plainWords(const std::string& message) {
  constexpr std::string_view kNoNumber = "Could not convert: ", kIs = " = ";
  if (message.starts_with(kNoNumber)) {
    const std::size_t end = std::min(message.find(kIs), message.size() - kIs.size());
    return fmt::format("{}: '{}' is not what it takes; give a number, and a whole one where it counts something",
                       message.substr(kNoNumber.size(), end - kNoNumber.size()), message.substr(end + kIs.size()));
  }
  const std::string flag = message.substr(0, message.find(':'));
  if (message.find("At Most 1 required but received") != std::string::npos)
    return flag + ": it is given more than once; give it once";
  if (message.find("1 required") != std::string::npos && message.ends_with("missing"))
    return flag + ": its value is missing; give one";
  return message;
}

// Reports an unknown flag first, since other errors may follow from it.
std::string parseMessage(const CLI::App& verb, const std::string& command, const CLI::ParseError& error) {
  const std::string help = fmt::format("'{} --help' says what may be given", command);
  const std::vector<std::string> unknown = verb.remaining(true);
  const auto flag =
      std::find_if(unknown.begin(), unknown.end(), [](const std::string& w) { return w.starts_with('-'); });
  if (flag != unknown.end()) {
    const std::string flag_alone = flag->substr(0, flag->find('='));
    return fmt::format("{}: not expected; {}", fmt::join(unknown, " "),
                       withDidYouMean(flag_alone, flagsOf(verb), help));
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !unknown.empty())
    return fmt::format("{}: not expected; {}", fmt::join(unknown, " "), help);
  return fmt::format("{}; {}", plainWords(error.what()), help);
}

}  // namespace palpate
