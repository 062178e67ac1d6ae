// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <cerrno>
#include <csignal>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "base/error.hpp"
#include "base/process_start.hpp"
#include "base/thread_names.hpp"
#include "command_words.hpp"
#include "engine/gpu/validation.hpp"
#include "version.hpp"

namespace {

using palpate::Error;
using palpate::exitStatus;

constexpr int kUnexpected = 1;

// How a verb ended. Without a message, everything was reported already.
struct Ending {
  int status = 0;
  std::string message;
};

// The verb that the words before the first flag name, and the words themselves; the program itself where they name
// none.
struct Addressed {
  const CLI::App* verb;
  std::string command;
};

// CLI11's own message would say only that a subcommand is required.
Addressed addressedVerb(const CLI::App& app, int argc, char** argv) {
  Addressed at{&app, app.get_name()};
  for (int i = 1; i < argc && argv[i][0] != '-' && at.verb->get_require_subcommand_min() > 0; ++i) {
    at.verb = &palpate::verbNamed(*at.verb, argv[i], at.command);
    at.command += " " + at.verb->get_name();
  }
  return at;
}

// What a thread cannot be started for: of ours, std::system_error; TBB, under OpenVDB, has only words.
bool isLackOfThreads(const std::exception& error) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  return (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) ||
         std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
}

Ending runVerb(CLI::App& app, const Addressed& addressed, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::RuntimeError& verdict) {
    return {verdict.get_exit_code(), ""};
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    static_cast<void>(app.exit(asked, text, text));
    palpate::printText(text.str());
    return {};
  } catch (const CLI::ParseError& error) {
    return {exitStatus(Error::Code::kBadInput), palpate::parseMessage(*addressed.verb, addressed.command, error)};
  } catch (const Error& error) {
    return {exitStatus(error.code()), error.what()};
  } catch (const std::bad_alloc&) {
    return {exitStatus(Error::Code::kOutOfMemory), "out of memory; use a smaller volume or close other programs"};
  } catch (const std::filesystem::filesystem_error& error) {
    return {exitStatus(Error::Code::kIo),
            fmt::format("{}: {}; check the name", error.path1().string(), error.code().message())};
  } catch (const std::exception& error) {
    if (isLackOfThreads(error)) {
      return {exitStatus(Error::Code::kIo), std::string("no thread can be started; ") + palpate::kFreeProcesses};
    }
    return {kUnexpected,
            fmt::format("unexpected: {}; please report this with the command that you gave", error.what())};
  }
}

// Results that did not reach their file or pipe are an error, though they were computed. Where the reader of a pipe has
// gone, the program ends as others do then: by the signal, and without a word.
int flushed(int status) {
  const int error = palpate::resultError();
  if (error == 0) return status;
  if (error == EPIPE) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  palpate::tellUser("standard output: it cannot be written to; make room or write elsewhere");
  return exitStatus(Error::Code::kIo);
}

// Under PALPATE_VALIDATION a run that the validation layer objects to has failed, whatever it printed.
int validated(int status) {
  for (const std::string& message : palpate::gpu::validationMessages()) {
    palpate::tellUser("validation layer: " + message);
    status = kUnexpected;
  }
  return status;
}

}  // namespace

namespace palpate {

int runProgram(int argc, char** argv, void (*addVerbs)(CLI::App&)) {
  static_cast<void>(processStart_ns());  // before any thread begins
  palpate::nameThisThread("palpate");    // whatever the name of the file is
  palpate::openClosedStreams();
  palpate::catchInterrupts();
  CLI::App app("Touch volumes: isosurface haptics over a Vulkan volume service.", "palpate");
  app.set_version_flag("-v,--version",
                       fmt::format("palpate {} ({})", palpate::programVersion(), palpate::programCommit()));
  app.require_subcommand(1);
  addVerbs(app);
  Ending ending;
  try {
    const Addressed addressed = addressedVerb(app, argc, argv);
    palpate::nameWork(addressed.command);
    ending = runVerb(app, addressed, argc, argv);
  } catch (const Error& error) {
    ending = {exitStatus(error.code()), error.what()};
  }
  palpate::endOfWork(ending.status);
  if (!ending.message.empty()) palpate::tellError(ending.message);
  return validated(flushed(ending.status));
}

}  // namespace palpate
