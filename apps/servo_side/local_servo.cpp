// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/local_servo.hpp"

#include <utility>

namespace palpate {

LocalServo::~LocalServo() {
  requestStop();
}

void LocalServo::makeLoop(const LoopParameters& loop, const RigSettings&, const RigVolume&,
                          std::unique_ptr<Algorithm> algorithm) {
  algorithm_ = std::move(algorithm);
  loop_.emplace(loop, *algorithm_, device_, windows_, tool_);
  loop_->takeChangesFrom(changes_);
}

std::uint64_t LocalServo::give(ServoChange change, const RigSettings&) {
  return changes_.give(std::move(change));
}

LoopResult LocalServo::runSimulated(const ServoLoop::Hook& before_tick) {
  return loop_->runSimulated(before_tick);
}

void LocalServo::requestStop() noexcept {
  if (loop_) loop_->requestStop();
}

}  // namespace palpate
