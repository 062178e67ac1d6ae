// SPDX-License-Identifier: Apache-2.0
// palpate: touch volumes. One file per verb; this one only starts them and reports what they throw.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/one_line.hpp"
#include "base/error.hpp"
#include "engine/gpu/validation.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace {

constexpr int kUnexpected = 1;

int report(const std::string& message, int status) {
  fmt::print(stderr, "palpate: {}\n", palpate::oneLine(message));
  return status;
}

// CLI11 would say only that a subcommand is required.
void checkVerb(const CLI::App& app, int argc, char** argv) {
  const CLI::App* at = &app;
  std::string command = app.get_name();
  for (int i = 1; i < argc && argv[i][0] != '-' && at->get_require_subcommand_min() > 0; ++i) {
    const auto verbs = at->get_subcommands([&](const CLI::App* verb) { return verb->check_name(argv[i]); });
    if (verbs.empty()) {
      throw palpate::Error(palpate::Error::Code::kBadInput, argv[i], "there is no such verb",
                           fmt::format("'{} --help' lists them", command));
    }
    at = verbs.front();
    command += " " + at->get_name();
  }
}

std::string parseMessage(const CLI::App* app, const CLI::Error& error) {
  std::string command = app->get_name();
  for (auto verbs = app->get_subcommands(); !verbs.empty(); verbs = verbs.front()->get_subcommands()) {
    command += " " + verbs.front()->get_name();
  }
  return fmt::format("palpate: {}; '{} --help' says what may be given\n", palpate::oneLine(error.what()), command);
}

// Results that did not reach their file or pipe are an error, though they were computed.
int flushed() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return report("standard output: it cannot be written to; make room or write elsewhere",
                palpate::exitStatus(palpate::Error::Code::kIo));
}

// Under PALPATE_VALIDATION a run that the validation layer objects to has failed, whatever it printed.
int validated(int status) {
  for (const std::string& message : palpate::gpu::validationMessages()) {
    status = report("validation layer: " + message, kUnexpected);
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Touch volumes: isosurface haptics over a Vulkan volume service.", "palpate");
  app.set_version_flag("--version",
                       fmt::format("palpate {} ({})", palpate::programVersion(), palpate::programCommit()));
  app.require_subcommand(1);
  app.failure_message(parseMessage);
  for (const auto& add : {palpate::addTouchVerb, palpate::addEditVerb, palpate::addRecoverVerb, palpate::addInfoVerb,
                          palpate::addConvertVerb, palpate::addGradientVerb, palpate::addFilterVerb,
                          palpate::addCheckVerb, palpate::addBenchVerb, palpate::addDevicesVerb, palpate::addPlanVerb,
                          palpate::addSceneVerb, palpate::addFaultsVerb}) {
    add(app);
  }
  palpate::catchInterrupts();
  try {
    checkVerb(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& verdict) {
    const int status = flushed();
    return status != 0 ? status : verdict.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? flushed() : palpate::exitStatus(palpate::Error::Code::kBadInput);
  } catch (const palpate::Error& error) {
    return report(error.what(), palpate::exitStatus(error.code()));
  } catch (const std::bad_alloc&) {
    return report("out of memory; use a smaller volume or close other programs",
                  palpate::exitStatus(palpate::Error::Code::kOutOfMemory));
  } catch (const std::filesystem::filesystem_error& error) {
    return report(fmt::format("{}: {}; check the name", error.path1().string(), error.code().message()),
                  palpate::exitStatus(palpate::Error::Code::kIo));
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return flushed();
    return report(fmt::format("unexpected: {}; please report this with the command that you gave", error.what()),
                  kUnexpected);
  }
  return validated(flushed());
}
