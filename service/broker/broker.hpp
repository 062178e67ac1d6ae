// SPDX-License-Identifier: Apache-2.0
// service/broker/broker.hpp: two things that a servo cannot do once it has given up its rights (service/sandbox), done
// by another process: the connection to an engine, and the opening of a HID device.
//
// The other process is a copy of this one, made before. It hears neither an engine nor a device: only requests of this
// process, whose kinds are these two, and it hands over open descriptors. So a servo that somebody has taken over opens
// no other file through it. Nor can it ask an engine for anything as a client does: a connection has carried the
// greeting of a servo when it arrives here, and an engine takes nothing but a servo's messages on it from then on.
//
// It has no capabilities, no rights to gain, and no memory image. It ends when this object does, or its process,
// however that ends, since their connection ends then; signals to end it before do nothing. Linux only.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include <sys/types.h>

#include "base/descriptor.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

class Broker {
 public:
  // What the other process does. An Error that a task throws is thrown here, too.
  struct Tasks {
    // A connection on which the greeting of a servo was sent, with this number and nothing else of the servo's choice.
    // Empty: it connects to nobody.
    std::function<Channel(std::uint64_t first_version)> greet = {};
    std::function<Descriptor(const std::string& path)> open = {};  // as openKnownNode() (apps/devices)
  };
  static constexpr std::chrono::milliseconds kPatience{10'000};  // for an answer

  // Starts the process; the only thread, before it starts others. Throws Error(kOutOfMemory) if none can be started
  // now. The tasks run over there, and see what was there at this moment. Descriptors but the standard ones, which go
  // nowhere, are not open there.
  explicit Broker(Tasks tasks, std::chrono::milliseconds patience = kPatience);
  ~Broker();  // its process ends; one that hangs is waited for a second, and ends when it can
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  // Any thread; they take turns. Blocking. Throw what the task threw; Error(kDevice) if the process is gone or does not
  // answer, and then at each call.
  [[nodiscard]] Channel greet(std::uint64_t first_version);
  [[nodiscard]] Descriptor open(const std::string& path);
  // It was asked in vain, and no call will work any more. Any thread; waits for nobody.
  [[nodiscard]] bool isGone() const noexcept { return is_gone_; }

 private:
  [[nodiscard]] Descriptor ask(char kind, const std::string& words);

  const int patience_ms_;
  std::mutex mutex_;  // guards the next
  Channel channel_;
  std::atomic<bool> is_gone_{false};
  pid_t process_ = -1;
};

}  // namespace palpate
