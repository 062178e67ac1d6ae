// SPDX-License-Identifier: Apache-2.0
// servo/loop/servo_links.hpp: leads a running servo from one engine to the next: other windows, another mailbox for its
// pose, an algorithm made for them.
//
// The servo tells its pose in the new mailbox too, so that the new engine knows where a window is needed. Once that has
// published one, the servo goes over to it between two ticks, and takes up its contact there. Until then it keeps what
// it had, and takes no changes, which are the new engine's. The force is the safety gate's: one that had faded, as the
// old windows had grown stale, grows from nothing. Threads: one thread gives links and takes them back; the servo's
// thread makes the other calls. Cost on the servo's side: a load, a store; wait-free. Heap, errors: none.
#pragma once

#include <atomic>
#include <memory>

#include "servo/algorithms/algorithm.hpp"
#include "servo/loop/live_ticks.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

struct ServoLink {
  WindowExchange* windows = nullptr;  // nothing in it counts as a window that the servo has had
  ToolPoseMailbox* tool = nullptr;
  std::unique_ptr<Algorithm> algorithm = {};  // afterwards the one that it replaced, if the loop owned that
  double force_limit_N = 0;                   // above 0 [N]
  bool doubtful = true;                       // InstabilityParameters::doubtful
  LiveTicks* ticks = nullptr;                 // who is told of each tick from then on; null: nobody
};

class ServoLinks {
 public:
  enum class State { kNone, kGiven, kHeard, kWithdrawn, kDone };

  // Giver: `link` is the servo's until state() is kDone, or withdraw() was answered. One at a time: state() is kNone or
  // kDone before.
  void give(ServoLink& link) noexcept {
    link_ = &link;
    state_.store(State::kGiven, std::memory_order_release);
  }
  // kHeard: the servo tells its pose there. kDone: it reads its windows there, and nothing of what it had before.
  [[nodiscard]] State state() const noexcept { return state_.load(std::memory_order_acquire); }
  // Giver: asks for a link that is not wanted any more. Answered when state() is kNone; or kDone, if it was too late.
  void withdraw() noexcept {
    State now = state();
    while ((now == State::kGiven || now == State::kHeard) &&
           !state_.compare_exchange_weak(now, State::kWithdrawn, std::memory_order_acq_rel)) {
    }
  }

  // Servo, between two ticks: the link to look at, or null.
  [[nodiscard]] ServoLink* offered() noexcept {
    const State now = state();
    if (now == State::kWithdrawn) state_.store(State::kNone, std::memory_order_release);
    return now == State::kGiven || now == State::kHeard ? link_ : nullptr;
  }
  // Servo, after its pose was told there.
  void heard() noexcept {
    State given = State::kGiven;
    state_.compare_exchange_strong(given, State::kHeard, std::memory_order_acq_rel);
  }
  // Servo, when it has gone over: it uses nothing of what it had before.
  void done() noexcept { state_.store(State::kDone, std::memory_order_release); }

 private:
  ServoLink* link_ = nullptr;
  std::atomic<State> state_{State::kNone};
};

}  // namespace palpate
