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
constexpr int kPatience_ms = 100;  // before the engine's door; it is tried again, and ends are looked for meanwhile
constexpr int kLooksForAnEngine = 10, kLooksAfterTrouble = 100;

class ServoKeeper {
 public:
  explicit ServoKeeper(const ServoKeeping& keeping)
      : keeping_(keeping), host_(true, keeping.commit, keeping.tell, keeping.ceilings) {}

  void run() {
    while (!keeping_.stopped()) {
      const bool again_soon = serveNext();
      const int looks = again_soon ? kLooksForAnEngine : kLooksAfterTrouble;
      for (int look = 0; look < looks && !keeping_.stopped(); ++look) std::this_thread::sleep_for(kLook);
    }
    keeping_.tell("it was told to end: the force goes to zero, and the device is let go");
  }

 private:
  // False: what was asked for cannot be, and will hardly be in a moment.
  bool serveNext() {
    std::optional<Channel> channel;
    try {
      channel = keeping_.reach(host_.firstVersion());
    } catch (const Error& error) {
      tellOnce(error.code() == Error::Code::kNotFound ? fmt::format("waiting for an engine at {}", keeping_.socket)
                                                      : std::string(error.what()));
      return true;
    }
    try {
      if (trouble_.empty()) tellOnce(fmt::format("an engine at {}", keeping_.socket));
      host_.serve(std::move(*channel), keeping_.stopped, true);
      if (keeping_.stopped()) return true;
      tellOnce("the engine has let go of the servo, which looks for it, or for the next one, again");
    } catch (const Error& error) {
      const bool is_gone = error.code() == Error::Code::kDevice && error.input() == "the engine";
      if (!is_gone) {
        if (std::exchange(trouble_, error.what()) != error.what())
          keeping_.tell(trouble_ + " (tried again every second)");
        return false;
      }
      tellOnce(
          fmt::format("the engine is gone; the force fades, and the servo waits for the next one ({})", error.what()));
    }
    trouble_.clear();
    return true;
  }

  void tellOnce(const std::string& words) {
    if (std::exchange(told_, words) != words) keeping_.tell(words);
  }

  const ServoKeeping& keeping_;
  ServoHost host_;
  std::string told_;     // last
  std::string trouble_;  // why it is no servo of the engine that is there; empty: none
};

}  // namespace

Channel reachEngine(const std::string& socket, const std::string& commit, std::uint64_t first_version) {
  Channel channel = connectTo(socket, kPatience_ms);
  if (!channel.send(greeting(commit, first_version, true), kPatience_ms))
    throw Error(Error::Code::kDevice, socket, "the service has ended, or does not listen any more",
                "look for its last message, and start it again");
  return channel;
}

void keepServo(const ServoKeeping& keeping) {
  ServoKeeper(keeping).run();
}

}  // namespace palpate
