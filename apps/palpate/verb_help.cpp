// SPDX-License-Identifier: Apache-2.0
// palpate help [VERB...]: what 'palpate VERB... --help' prints.
#include "apps/console/message.hpp"
#include "command_words.hpp"
#include "verbs.hpp"

namespace palpate {

void addHelpVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("help", "say what a verb does and which flags it takes");
  auto names = std::make_shared<std::vector<std::string>>();
  verb->add_option("verb", *names, "touch, check filters, ...; without it the program itself");
  verb->callback([names, &app] {
    const CLI::App* asked = &app;
    std::string above, command = app.get_name();
    for (const std::string& name : *names) {
      asked = &verbNamed(*asked, name, command);
      above = command;
      command += " " + asked->get_name();
    }
    // For the program itself, CLI11 would print the help of the verb given, which is `help`.
    printText(asked == &app ? app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal)
                            : asked->help(above));
  });
}

}  // namespace palpate
