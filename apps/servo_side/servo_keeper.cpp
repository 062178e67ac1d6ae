// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_keeper.hpp"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/servo_side/servo_host.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds kLook{10};
constexpr int kLooksForAnEngine = 10;

class ServoKeeper {
 public:
  explicit ServoKeeper(const ServoKeeping& keeping) : keeping_(keeping), host_(true, keeping.commit) {}

  void run() {
    while (!keeping_.stopped()) {
      serveNext();
      for (int look = 0; look < kLooksForAnEngine && !keeping_.stopped(); ++look) std::this_thread::sleep_for(kLook);
    }
  }

 private:
  void serveNext() {
    bool is_there = false;
    try {
      Channel channel = connectTo(keeping_.socket);
      const std::uint32_t user = channel.peer().user;
      if (user != geteuid() && user != 0) {
        refuse(keeping_.socket, fmt::format("user {} listens there", user),
               "start the service as the user of the servo");
      }
      is_there = true;
      tellOnce(fmt::format("an engine at {}", keeping_.socket));
      host_.serve(std::move(channel), keeping_.stopped);
      tellOnce("the engine has left; the servo waits for the next one");
    } catch (const Error& error) {
      tellOnce(is_there && error.code() == Error::Code::kDevice
                   ? fmt::format("the engine is gone; the force fades, and the servo waits for the next one ({})",
                                 error.what())
                   : std::string(error.what()));
    }
  }

  void tellOnce(const std::string& words) {
    if (std::exchange(told_, words) != words) keeping_.tell(words);
  }

  const ServoKeeping& keeping_;
  ServoHost host_;
  std::string told_;
};

}  // namespace

void keepServo(const ServoKeeping& keeping) {
  ServoKeeper(keeping).run();
}

}  // namespace palpate
