// SPDX-License-Identifier: Apache-2.0
#include "completion.hpp"

#include <algorithm>
#include <functional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/scene/option_table.hpp"
#include "command_words.hpp"

namespace palpate {
namespace {

struct Flag {
  std::vector<std::string> names;
  std::string help;
  std::vector<std::string> words;  // that it takes; empty: any
};

// A word with what it does.
using Explained = std::pair<std::string, std::string>;

// A verb by its place under the program: "" (the program itself), "touch", "bench servo".
struct Verb {
  std::string place;
  std::vector<Explained> words;  // that may follow it: its own verbs, or the words that it takes without a flag
  std::vector<Flag> flags;
};

// The words of a scene's flag come from the option table, those of another from its check ("{float,half}" in CLI11).
std::vector<std::string> wordsOf(const CLI::Option& option) {
  for (const SceneOption& row : sceneOptions()) {
    if (option.check_lname(std::string(row.flag).substr(2)))
      return isBare(row.value) ? std::vector<std::string>() : optionWords(row.value);
  }
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

std::vector<Flag> flagsWithWords(const CLI::App& verb) {
  std::vector<Flag> flags;
  for (const CLI::Option* option : verb.get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    Flag flag{{}, option->get_description(), wordsOf(*option)};
    for (const std::string& name : option->get_lnames()) flag.names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) flag.names.push_back("-" + name);
    flags.push_back(std::move(flag));
  }
  return flags;
}

// Words that a verb takes without a flag: 'completion bash'.
std::vector<Explained> wordsInPlace(const CLI::App& verb) {
  std::vector<Explained> words;
  for (const CLI::Option* option : verb.get_options([](const CLI::Option* o) { return !o->nonpositional(); })) {
    for (const std::string& word : wordsOf(*option)) words.emplace_back(word, option->get_description());
  }
  return words;
}

std::vector<Verb> verbsUnder(const CLI::App& app, const std::string& place) {
  Verb self{place, wordsInPlace(app), flagsWithWords(app)};
  std::vector<Verb> all;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    self.words.emplace_back(verb->get_name(), verb->get_description());
    const std::vector<Verb> below =
        verbsUnder(*verb, place.empty() ? verb->get_name() : place + " " + verb->get_name());
    all.insert(all.end(), below.begin(), below.end());
  }
  all.insert(all.begin(), std::move(self));
  return all;
}

// After 'help' every verb may follow, with its own verbs but without its flags.
std::vector<Verb> everyVerb(const CLI::App& app) {
  std::vector<Verb> all = verbsUnder(app, "");
  const auto help = std::find_if(all.begin(), all.end(), [](const Verb& verb) { return verb.place == "help"; });
  if (help == all.end()) return all;
  const auto isPlace = [&](const std::string& place) {
    return std::any_of(all.begin(), all.end(), [&](const Verb& verb) { return verb.place == place; });
  };
  std::vector<Verb> asked;
  for (const Verb& verb : all) {
    if (verb.place.empty()) continue;
    asked.push_back({"help " + verb.place, verb.words, help->flags});
    std::erase_if(asked.back().words, [&](const Explained& word) { return !isPlace(verb.place + " " + word.first); });
  }
  help->words = all.front().words;
  all.insert(all.end(), asked.begin(), asked.end());
  return all;
}

// Quotes a text as one word of a shell.
std::string inQuotes(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

// The places of all verbs, as patterns of a shell's case.
std::string places(const std::vector<Verb>& verbs) {
  std::vector<std::string> words;
  for (const Verb& verb : verbs) {
    if (!verb.place.empty()) words.push_back(inQuotes(verb.place));
  }
  return fmt::format("{}", fmt::join(words, "|"));
}

// A case for each flag that takes certain words: 'touch --clock'.
std::string valueCases(const std::vector<Verb>& verbs, const char* open, const char* close) {
  std::string text;
  for (const Verb& verb : verbs) {
    for (const Flag& flag : verb.flags) {
      if (flag.words.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : flag.names) patterns.push_back(inQuotes(verb.place + " " + name));
      text +=
          fmt::format("    {}) values={}{}{} ;;\n", fmt::join(patterns, "|"), open, fmt::join(flag.words, " "), close);
    }
  }
  return text;
}

// "name:what it does", which zsh's _describe takes.
std::string described(const std::string& name, const std::string& help) {
  std::string text = name + ":";
  for (const char c : help) text += c == ':' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return inQuotes(text);
}

}  // namespace

std::string bashCompletion(const CLI::App& app) {
  const std::vector<Verb> verbs = everyVerb(app);
  // --flag=val is three words where '=' breaks them, as bash does by default, else one.
  std::string text =
      R"(# palpate completion bash: source <(palpate completion bash)
_palpate() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local place= values= words= flags= front= valued= i
  if [[ $word == --*=* ]]; then valued=1 front=${word%%=*}= before=${word%%=*} word=${word#*=}
  elif [[ $word == = ]]; then valued=1 word=
  elif [[ $before == = ]]; then valued=1 before=${COMP_WORDS[COMP_CWORD - 2]}; fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${place:+$place }${COMP_WORDS[i]}" in
)";
  text += fmt::format("      {}) place=${{place:+$place }}${{COMP_WORDS[i]}} ;;\n      *) break ;;\n    esac\n  done\n",
                      places(verbs));
  text += "  case \"$place $before\" in\n" + valueCases(verbs, "'", "'") + "  esac\n";
  text += "  case $place in\n";
  for (const Verb& verb : verbs) {
    std::vector<std::string> names, flags;
    for (const auto& [name, help] : verb.words) names.push_back(name);
    for (const Flag& flag : verb.flags) flags.insert(flags.end(), flag.names.begin(), flag.names.end());
    text += fmt::format("    {}) words='{}' flags='{}' ;;\n", inQuotes(verb.place), fmt::join(names, " "),
                        fmt::join(flags, " "));
  }
  return text +
         R"(  esac
  if [[ -n $values ]]; then COMPREPLY=($(compgen -P "$front" -W "$values" -- "$word"))
  elif [[ -n $valued ]]; then COMPREPLY=()
  elif [[ $word == -* ]]; then COMPREPLY=($(compgen -W "$flags" -- "$word"))
  else COMPREPLY=($(compgen -W "$words" -- "$word")); fi
}
complete -o default -F _palpate palpate
)";
}

std::string zshCompletion(const CLI::App& app) {
  const std::vector<Verb> verbs = everyVerb(app);
  std::string text =
      R"(#compdef palpate
# palpate completion zsh: source <(palpate completion zsh), or a file _palpate in $fpath
_palpate() {
  local place= valued= before=${words[CURRENT-1]} i
  local -a values verbs flags
  if [[ ${words[CURRENT]} == --*=* ]]; then
    valued=1 before=${words[CURRENT]%%=*}
    compset -P '*='
  fi
  for ((i = 2; i < CURRENT; ++i)); do
    case "${place:+$place }${words[i]}" in
)";
  text += fmt::format("      {}) place=\"${{place:+$place }}${{words[i]}}\" ;;\n      *) break ;;\n    esac\n  done\n",
                      places(verbs));
  text += "  case \"$place $before\" in\n" + valueCases(verbs, "(", ")") + "  esac\n";
  text += "  case \"$place\" in\n";
  for (const Verb& verb : verbs) {
    std::vector<std::string> names, flags;
    for (const auto& [name, help] : verb.words) names.push_back(described(name, help));
    for (const Flag& flag : verb.flags) {
      for (const std::string& name : flag.names) flags.push_back(described(name, flag.help));
    }
    text += fmt::format("    {})\n      verbs=({})\n      flags=({}) ;;\n", inQuotes(verb.place), fmt::join(names, " "),
                        fmt::join(flags, "\n        "));
  }
  return text +
         R"(  esac
  if (( ${#values} )); then compadd -a values
  elif [[ -n $valued ]]; then _files
  elif [[ ${words[CURRENT]} == -* ]]; then _describe -o flag flags
  elif (( ${#verbs} )); then _describe verb verbs
  else _files; fi
}
if [[ ${funcstack[1]} == _palpate ]]; then _palpate "$@"; else compdef _palpate palpate; fi
)";
}

}  // namespace palpate
