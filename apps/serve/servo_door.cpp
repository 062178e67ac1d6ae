// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/servo_door.hpp"

#include <utility>

#include "base/thread_names.hpp"

namespace palpate {
namespace {

constexpr int kDevicePatience_ms = 10'000;  // with a servo that makes its device
constexpr int kLoopPatience_ms = 2000;      // with one that makes its loop, while nobody's edit is made

}  // namespace

ServoDoor::ServoDoor(Ours ours, Tell tell) : ours_(std::move(ours)), tell_(std::move(tell)) {}

bool ServoDoor::letIn(Channel&& channel, const wire::HelloT& hello) {
  processes_.note(channel.peer().process);
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(has_one_, true)) return false;
  }
  // The thread before has ended, or there would still be its servo.
  try {
    greeter_ =
        std::jthread([this, hello, channel = std::move(channel)]() mutable { greet(std::move(channel), hello); });
  } catch (...) {
    hasLeft();
    throw;
  }
  return true;
}

void ServoDoor::greet(Channel channel, const wire::HelloT& hello) {
  nameThisThread("greeter");
  const Vec3 begins_there_W = ours_.way != nullptr ? ours_.way->position(0) : Vec3::Zero();
  try {
    auto servo = std::make_unique<RemoteServo>(
        std::move(channel), RemoteServo::Request{.scene = ours_.scene,
                                                 .box = ours_.box,
                                                 .way = ours_.way,
                                                 // Until an onlooker's pointer leads it:
                                                 .pointer = ours_.way != nullptr ? &begins_there_W : nullptr,
                                                 .told_ticks = ours_.told_ticks,
                                                 .window_samples = ours_.window_samples,
                                                 .commit = ours_.commit,
                                                 .hello = &hello,
                                                 .patience_ms = kDevicePatience_ms,
                                                 .loop_patience_ms = kLoopPatience_ms});
    processes_.note(servo->process());
    const std::lock_guard lock(mutex_);
    next_ = std::move(servo);
  } catch (const std::exception& error) {
    hasLeft();
    tellTrouble(error.what());
  }
}

std::unique_ptr<RemoteServo> ServoDoor::takeNext() {
  const std::lock_guard lock(mutex_);
  return std::move(next_);
}

void ServoDoor::hasLeft() {
  const std::lock_guard lock(mutex_);
  has_one_ = false;
}

void ServoDoor::tellTrouble(const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(trouble_, why) == why) return;
  }
  tell_(why);
}

void ServoDoor::noTrouble() {
  const std::lock_guard lock(mutex_);
  trouble_.clear();
}

void ServoDoor::close() {
  if (greeter_.joinable()) greeter_.join();
}

}  // namespace palpate
