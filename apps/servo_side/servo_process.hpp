// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_process.hpp: starts a servo's process beside this one, and ends it. Set-up code. Linux only.
#pragma once

#include <filesystem>

#include <sys/types.h>

#include "service/channel/channel.hpp"

namespace palpate {

// Where the servo's program lies: in the folder of this one.
[[nodiscard]] std::filesystem::path servoProgram();

class ServoProcess {
 public:
  // Starts servoProgram(). Throws Error: kNotFound if it is not there, kIo if no process can
  // be started.
  ServoProcess();
  // Waits for its end, since it has a device to bring to rest: for kPatience_ms, then it is killed. Close the channel
  // before. A fade may take longer than that by the servo's own ceilings; who runs a loop over there has waited for its
  // end already (RemoteServo).
  ~ServoProcess();
  ServoProcess(const ServoProcess&) = delete;
  ServoProcess& operator=(const ServoProcess&) = delete;
  static constexpr int kPatience_ms = 13'000;

  [[nodiscard]] Channel takeChannel() noexcept { return std::move(channel_); }  // once
  [[nodiscard]] pid_t id() const noexcept { return id_; }

 private:
  Channel channel_;
  pid_t id_ = -1;
};

}  // namespace palpate
