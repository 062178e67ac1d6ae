// SPDX-License-Identifier: Apache-2.0
// palpate faults: every fault of the servo, what it does to the force and what to do, as docs/faults.md has it.
#include <fmt/format.h>

#include "apps/console/document.hpp"
#include "servo/safety/faults.hpp"
#include "verbs.hpp"

namespace palpate {

void addFaultsVerb(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("faults", "print every fault of the servo: what it does to the force, what to do");
  verb->callback([] { printDocument(faultDocument()); });
}

}  // namespace palpate
