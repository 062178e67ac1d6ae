// SPDX-License-Identifier: Apache-2.0
// servo/loop/servo_changes.hpp: hands changes (another algorithm, another force limit) to the running servo without a
// wait.
//
// Once a tick the servo takes the newest change, or none. What it no longer needs it hands back, so that it never frees
// memory. Threads: give() and withdraw() by any thread; take() and done() by the servo's. Cost: take() one load, and one exchange if
// there is a change; done() one store. Wait-free on the servo's side, a lock on the other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "servo/algorithms/algorithm.hpp"

namespace palpate {

struct ServoChange {
  std::unique_ptr<Algorithm> algorithm = {};  // runs from now on; null: keeps the present one
  std::optional<double> force_limit_N = {};   // above 0; empty: keeps the present one [N]
  bool doubtful = true;                       // InstabilityParameters::doubtful, with a new algorithm
  std::uint64_t number = 0;                   // set by give()
};

class ServoChanges {
 public:
  ServoChanges() = default;
  ~ServoChanges();
  ServoChanges(const ServoChanges&) = delete;
  ServoChanges& operator=(const ServoChanges&) = delete;

  // A change that the servo has not taken yet is merged into this one. Frees what the servo has handed back. Throws
  // Error(kBadInput) for a force limit that is not above 0; then nothing changes.
  // Returns the change's number; the newest has the highest.
  std::uint64_t give(ServoChange change);
  // Takes back what the servo has not taken yet.
  void withdraw();
  // Whether the servo has taken the change of this number and completed it: nothing that it replaced runs any more. Any
  // thread.
  [[nodiscard]] bool ended(std::uint64_t number) const noexcept {
    return ended_.load(std::memory_order_acquire) >= number;
  }

  // Servo: the change to make, or null. It belongs to the servo until done(). One at a time.
  [[nodiscard]] ServoChange* take() noexcept;
  // Servo: hands back what take() gave; it may hold the algorithm that was replaced.
  void done(ServoChange* change) noexcept;

 private:
  std::mutex givers_;
  std::uint64_t given_count_ = 0;        // guarded by givers_
  std::atomic<std::uint64_t> ended_{0};  // the number of the change that ended last
  std::atomic<ServoChange*> given_{nullptr};
  // Changes that the servo has handed back. Each give() empties these slots, and each take() needs a give() before it.
  // So at most two are filled: with the change that the servo had at that give(), and with the one that it took since.
  std::array<std::atomic<ServoChange*>, 2> done_{};
};

}  // namespace palpate
