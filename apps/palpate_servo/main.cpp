// SPDX-License-Identifier: Apache-2.0
// palpate-servo: the servo as a process of its own, for an engine in another one. Links neither Vulkan nor OpenVDB, so
// no fault in graphics code can end it.
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "apps/console/message.hpp"
#include "apps/servo_side/servo_host.hpp"
#include "base/error.hpp"

namespace {

constexpr int kUsage = 2, kUnexpected = 1;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 || std::strcmp(argv[1], "--channel") != 0) {
    palpate::tellUser("palpate-servo: an engine starts it; see 'palpate touch --service'");
    return kUsage;
  }
  // A signal to the whole group is the engine's to answer: the force goes to zero when its channel says so, or is
  // closed.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) static_cast<void>(std::signal(signal, SIG_IGN));
  try {
    palpate::runServoHost(palpate::Channel(palpate::Descriptor(std::atoi(argv[2]))));
    return 0;
  } catch (const palpate::Error& error) {  // the engine has been told, or is not there
    return palpate::exitStatus(error.code());
  } catch (const std::exception& error) {
    palpate::tellUser(error.what());
    return kUnexpected;
  }
}
