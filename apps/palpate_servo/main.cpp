// SPDX-License-Identifier: Apache-2.0
// palpate-servo: the servo as a process of its own, for an engine in another one. Links neither Vulkan nor OpenVDB, so
// no fault in graphics code can end it.
//
// --channel N: for the engine that started it, at the descriptor N; ends with it. --connect SOCKET: for the engines
// that listen there, one after another, until SIGTERM or SIGINT. Before either it gives up its rights
// (service/sandbox), but for --no-sandbox behind them, with which a debugger can look into it. A second process then
// connects to engines and opens HID devices for it (service/broker). Behind --connect may also stand what it never
// exceeds (apps/servo_side/servo_ceilings.hpp), and --calibrated.
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "apps/console/message.hpp"
#include "apps/servo_rights/give_up_rights.hpp"
#include "apps/servo_side/servo_host.hpp"
#include "apps/servo_side/servo_keeper.hpp"
#include "base/close_from.hpp"
#include "base/descriptor.hpp"
#include "base/error.hpp"
#include "base/user_folders.hpp"
#include "service/broker/broker.hpp"
#include "service/sandbox/servo_sandbox.hpp"
#include "version.hpp"

namespace {

constexpr int kUsage = 2, kUnexpected = 1;

volatile std::sig_atomic_t stop_asked = 0;

void askToStop(int) {
  stop_asked = 1;
}

void tell(const std::string& words) {
  palpate::tellUser("servo: " + words);
}

// A shell opens its terminal once, to read and to write, and gives that as each of the standard streams.
// False: it stays as it is, since it is another user's, who cannot open it again.
bool onlyWriteTo(int output) {
  if (isatty(output) == 0) return true;
  const palpate::Descriptor writes(
      open(("/proc/self/fd/" + std::to_string(output)).c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC));
  return writes && dup2(writes.get(), output) == output;
}

// Whoever started this program may have left files open, which could still be written to, and a terminal, in which
// somebody types. False: that can still be read.
bool closeWhatIsLeft(int but) {
  // The number of a standard stream that is closed would be that of the next socket, and messages would go there.
  int nothing = open("/dev/null", O_RDWR);
  while (nothing >= 0 && nothing <= STDERR_FILENO) nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  close(nothing);
  palpate::closeFrom(STDERR_FILENO + 1, palpate::Closing::kNow, but);
  const bool output = onlyWriteTo(STDOUT_FILENO), errors = onlyWriteTo(STDERR_FILENO);
  return output && errors;
}

// In which the servo notes that a device is calibrated, and takes that back: made now, since later it cannot be. Empty:
// there is none.
std::string ownFolder() {
  const std::filesystem::path folder = palpate::calibrationsFolder();
  std::error_code ignored;
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  return std::filesystem::is_directory(folder, ignored) ? folder.string() : std::string();
}

// Without its broker a servo never gets a device back that was unplugged, so it ends, and whoever watches over it
// starts another one. It is known to be gone once a device that is back was asked of it in vain.
void checkBroker(const palpate::Broker* broker) {
  if (broker != nullptr && broker->isGone())
    throw std::runtime_error(
        "the servo's broker: it is gone, and the device was to be opened again; start the servo "
        "again");
}

// A signal to the whole group is the engine's to answer: the force goes to zero when its channel says so, or is closed.
void serveMaker(const char* number, const palpate::ServoCeilings& ceilings, const palpate::Broker* broker) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) static_cast<void>(std::signal(signal, SIG_IGN));
  const int descriptor = std::atoi(number);
  fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  palpate::ServoHost(false, palpate::programCommit(), tell, ceilings)
      .serve(palpate::Channel(palpate::Descriptor(descriptor)), [broker] {
        checkBroker(broker);
        return false;
      });
}

palpate::Channel reach(const std::string& socket, std::uint64_t first_version) {
  return palpate::reachEngine(socket, palpate::programCommit(), first_version);
}

// Without its broker a servo finds no engine any more, so it ends, and whoever watches over it starts another one.
palpate::Channel reachBy(palpate::Broker& broker, std::uint64_t first_version) {
  try {
    return broker.greet(first_version);
  } catch (const palpate::Error& error) {
    if (broker.isGone()) throw std::runtime_error(error.what());
    throw;
  }
}

// `broker`: null where the servo kept the right to connect itself.
void serveWhoeverListens(const std::string& socket, const palpate::ServoCeilings& ceilings, palpate::Broker* broker) {
  for (const int signal : {SIGINT, SIGTERM}) static_cast<void>(std::signal(signal, askToStop));
  static_cast<void>(std::signal(SIGHUP, SIG_IGN));
  palpate::keepServo({.socket = socket,
                      .commit = palpate::programCommit(),
                      .reach =
                          [&](std::uint64_t first_version) {
                            return broker != nullptr ? reachBy(*broker, first_version) : reach(socket, first_version);
                          },
                      .ceilings = ceilings,
                      .stopped =
                          [broker] {
                            if (stop_asked == 0) checkBroker(broker);
                            return stop_asked != 0;
                          },
                      .tell = tell});
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_made = argc >= 3 && std::strcmp(argv[1], "--channel") == 0;
  const bool stays = argc >= 3 && std::strcmp(argv[1], "--connect") == 0;
  bool is_open = false, is_known = is_made || stays;
  // Who starts an engine that starts its servo says of both whether the device is calibrated.
  palpate::ServoCeilings ceilings{.takes_calibrated = is_made};
  bool engine_is_told = false;  // of errors from now on
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));
  try {
    for (int i = 3; i < argc && is_known; ++i) {
      const std::string word = argv[i];
      if (word == "--no-sandbox") {
        is_open = true;
      } else if (stays && word == "--calibrated") {
        ceilings.takes_calibrated = true;
      } else {
        is_known = stays && i + 1 < argc && palpate::setCeiling(ceilings, word, argv[i + 1]);
        ++i;
      }
    }
    if (!is_known) {
      palpate::tellUser("palpate-servo: an engine starts it, or 'palpate servo --connect SOCKET'");
      return kUsage;
    }
    ceilings = palpate::tighter(ceilings, palpate::ceilingsOfFile(palpate::ceilingsFile()));
    palpate::WithoutRights without;
    if (is_open) {
      palpate::tellUser("servo: --no-sandbox: it keeps all its rights, and is for debugging only");
    } else {
      const bool reads_nothing = closeWhatIsLeft(is_made ? std::atoi(argv[2]) : STDERR_FILENO);
      palpate::RightsNeeded needed{.modules = {PALPATE_SERVO_MODULES}, .own_folder = ownFolder()};
      if (stays) needed.greet = [socket = std::string(argv[2])](std::uint64_t number) { return reach(socket, number); };
      without = palpate::giveUpRights(needed);
      if (!reads_nothing)
        without.report.missing.emplace_back("reading a terminal of another user (start it from one of its own user)");
      // What an engine starts is part of its run, which says enough: only what is missing is told there.
      if (!is_made || !without.report.missing.empty()) tell(palpate::wordsOf(without.report));
    }
    engine_is_told = is_made;
    palpate::Broker* const broker = without.broker.get();
    is_made ? serveMaker(argv[2], ceilings, broker) : serveWhoeverListens(argv[2], ceilings, broker);
    return 0;
  } catch (const palpate::Error& error) {
    if (!engine_is_told) palpate::tellError(error.what());
    return palpate::exitStatus(error.code());
  } catch (const std::exception& error) {
    palpate::tellError(error.what());
    return kUnexpected;
  }
}
