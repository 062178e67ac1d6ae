// SPDX-License-Identifier: Apache-2.0
// apps/serve/brush_holders.hpp: whose brush the tool holds, of several windows, whose questions may wait for others:
// who has let go of the button, or has gone, holds none, however late the question to hold one is done. Any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>

namespace palpate {

// Who can hold a brush.
class BrushHand {
 private:
  friend class BrushHolders;
  std::uint64_t releases_ = 0;  // guarded by the lock of BrushHolders
};

class BrushHolders {
 public:
  enum class Turn : std::uint64_t {};

  [[nodiscard]] Turn ask(const BrushHand& one) const {
    const std::lock_guard lock(mutex_);
    return Turn{one.releases_};
  }
  // `take` is called unless it has released since it asked; what that throws leaves all as it was.
  template <typename Take>
  void hold(const std::shared_ptr<BrushHand>& one, Turn turn, const Take& take) {
    const std::lock_guard lock(mutex_);
    if (turn != Turn{one->releases_}) return;
    take();
    holder_ = one;
  }
  // `drop` is called if the tool holds its brush.
  template <typename Drop>
  void release(const std::shared_ptr<BrushHand>& one, const Drop& drop) {
    const std::lock_guard lock(mutex_);
    ++one->releases_;
    if (holder_.lock() != one) return;
    holder_.reset();
    drop();
  }

 private:
  mutable std::mutex mutex_;
  std::weak_ptr<BrushHand> holder_;
};

}  // namespace palpate
