// SPDX-License-Identifier: Apache-2.0
// palpate-sculpt: the verb `sculpt` as a program of its own, with the libraries of a desktop. `palpate` starts it.
#include "apps/console/message.hpp"
#include "apps/palpate/program.hpp"
#include "apps/palpate/verbs.hpp"
#include "apps/window/run_window.hpp"

namespace {

void addVerbs(CLI::App& app) {
  palpate::addSculptVerb(app, [](const palpate::SculptRequest& request, const std::vector<std::string>& idle) {
    for (const std::string& words : idle) palpate::tellUser(words);
    palpate::runWindow(request);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::runProgram(argc, argv, addVerbs);
}
