// SPDX-License-Identifier: Apache-2.0
// servo/loop/instability_guard.hpp: notices an unstable contact while the servo runs, and ends it quietly.
//
// The guard does not know where the hand wants the tool. A contact is unstable if one of these is true:
// - its swings are fast and do not settle (swing_watch.hpp);
// - the wall may be too stiff for the device (`doubtful`), and the tool bounces on it (giving_touches.hpp).
// Then the guard raises kUnstable. That fades the force, and hand and device damp the tool. The force stays away until
// the tool has been away from the surface for `away_s`. It comes back with `softer` times the stiffness and damping of
// before: every force of the algorithm is multiplied by that. A wall that is soft enough is stable in any hand, so
// after a few rounds the contact is quiet. New settings have the whole force again: at once where the tool is away,
// else as what an edit adds (ServoLoop::takeChangesFrom()).
//
// How soon: a tick after the 20th swing (SwingWatch::kSwings) has ended. For swings as fast as SwingWatch::kHand_hz
// that is at most 20 / (2 * 12 Hz) * rate + 1 ticks, 834 at 1 kHz; 101 for a contact that swings at 100 Hz. Slower
// swings are noticed if they grow, after as many periods. Slower bounces are noticed a tick after the 10th touch, or
// after the 20th at the latest.
//
// Frame W. Thread: the servo's. Cost: that of SwingWatch. Heap, errors: none.
#pragma once

#include <cstdint>

#include "servo/devices/device.hpp"
#include "servo/loop/giving_touches.hpp"
#include "servo/loop/swing_watch.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct InstabilityParameters {
  bool act = true;       // false: unstable contacts are left to swing
  bool doubtful = true;  // false: the wall is known to be stable with this device in any hand
  double away_s = 1;     // how long the tool must have been away before the force comes back [s]
  double softer = 0.25;  // share of the force that is left then [-]
};

class InstabilityGuard {
 public:
  // It does not act on a device that no force moves. Throws Error(kBadInput) unless 0 <= away_s <= 60 and
  // 0 < softer < 1.
  InstabilityGuard(const InstabilityParameters& parameters, const DeviceLimits& device, double rate_hz);

  // The tick that has just been run.
  void add(const TickRecord& record) noexcept;

  // kUnstable while the force is kept away, else 0.
  [[nodiscard]] std::uint32_t faults() const noexcept;
  // What the algorithm's force is multiplied by [-].
  [[nodiscard]] double share() const noexcept { return share_; }

  // A new algorithm: its whole force. Its share begins at 1; who makes the change lets it come in. A force that is kept
  // away stays so until the tool has been away: the hand may have sunk deep into the surface.
  void takeNew(bool doubtful) noexcept;

 private:
  InstabilityParameters parameters_;
  SwingWatch watch_;
  GivingTouches touches_;
  std::int64_t away_ticks_;      // `away_s` in ticks
  std::int64_t away_since_ = 0;  // ticks without contact, while the force is kept away
  double share_ = 1;
  bool unstable_ = false;
};

}  // namespace palpate
