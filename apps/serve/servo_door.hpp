// SPDX-License-Identifier: Apache-2.0
// apps/serve/servo_door.hpp: where servos come to a service, one at a time. One that has connected makes its device,
// which may take seconds: a thread of its own waits for that, while the engine goes on.
// Threads: letIn() by one, takeNext() by the engine's, the rest by any.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "apps/serve/servo_processes.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

class ServoDoor {
 public:
  struct Ours {
    const Scene& scene;          // whose device servos make; outlives the door
    VolumeBox box;               // of the volume
    const SampledPath* way;      // of a device that nobody holds; null: none. Outlives the door
    std::size_t told_ticks = 0;  // as RemoteServo::Request has them
    std::size_t window_samples = 0;
    std::string commit;  // of this program
  };
  using Tell = std::function<void(const std::string&)>;
  ServoDoor(Ours ours, Tell tell);

  // A servo that has connected, and said this. False, and the channel stays the caller's: one is there already, or on
  // its way.
  [[nodiscard]] bool letIn(Channel&& channel, const wire::HelloT& hello);
  // One whose device is ready; null: none. It is there until hasLeft().
  [[nodiscard]] std::unique_ptr<RemoteServo> takeNext();
  void hasLeft();
  // Whether this process is a servo that was here, or has connected one. It asks for nothing as clients do: a servo has
  // given up the right to change files, and would have them changed.
  [[nodiscard]] bool isServo(std::int64_t process) { return processes_.contains(process); }
  // Why a servo did not come to be; told once, however often it tries again.
  void tellTrouble(const std::string& why);
  void noTrouble();
  // Waits for the one that is on its way, which is not taken.
  void close();

 private:
  void greet(Channel channel, const wire::HelloT& hello);

  const Ours ours_;
  const Tell tell_;
  ServoProcesses processes_;
  std::mutex mutex_;  // guards what follows
  bool has_one_ = false;
  std::unique_ptr<RemoteServo> next_;
  std::string trouble_;
  std::jthread greeter_;  // last member: it uses the others
};

}  // namespace palpate
