// SPDX-License-Identifier: Apache-2.0
// palpate completion bash|zsh: a script that completes verbs, flags and their words.
#include "apps/console/message.hpp"
#include "completion.hpp"
#include "verbs.hpp"

namespace palpate {

void addCompletionVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("completion", "print a script that completes verbs and flags in a shell");
  verb->footer("In ~/.bashrc or ~/.zshrc (there behind compinit): source <(palpate completion bash)");
  auto shell = std::make_shared<std::string>();
  verb->add_option("shell", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  verb->callback([shell, &app] { printText(*shell == "zsh" ? zshCompletion(app) : bashCompletion(app)); });
}

}  // namespace palpate
