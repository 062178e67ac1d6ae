// SPDX-License-Identifier: Apache-2.0
// palpate: touch volumes. One file per verb; this one only starts them and reports what they throw.
#include <fmt/format.h>

#include <exception>
#include <new>

#include "apps/console/interrupt.hpp"
#include "base/error.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace {

constexpr int kUnexpected = 1;

int report(const std::string& message, int status) {
  fmt::print(stderr, "palpate: {}\n", message);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Touch volumes: isosurface haptics over a Vulkan volume service.", "palpate");
  app.set_version_flag("--version", fmt::format("palpate {} ({})", palpate::programVersion(), palpate::programCommit()));
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  for (const auto& add : {palpate::addTouchVerb, palpate::addInfoVerb, palpate::addCheckVerb, palpate::addDevicesVerb,
                          palpate::addPlanVerb, palpate::addSceneVerb}) {
    add(app);
  }
  palpate::catchInterrupts();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status == 0 ? 0 : palpate::exitStatus(palpate::Error::Code::kBadInput);
  } catch (const palpate::Error& error) {
    return report(error.what(), palpate::exitStatus(error.code()));
  } catch (const std::bad_alloc&) {
    return report("out of memory; use a smaller volume or close other programs",
                  palpate::exitStatus(palpate::Error::Code::kOutOfMemory));
  } catch (const std::exception& error) {
    return report(fmt::format("unexpected: {}; please report this with the command that you gave", error.what()), kUnexpected);
  }
  return 0;
}
