// SPDX-License-Identifier: Apache-2.0
// servo/safety/passivity.hpp: does the virtual environment give more energy to the hand than it took? Observer and
// controller.
//
// Observer. The device holds the force F of a tick until the next one, so the work that it does on the hand over the
// tick is F . (x_next - x), exactly, whatever the way between. E is the sum of what the environment took,
//   E -= F_last . (x - x_last),  E >= 0: passive so far, E < 0: it has given away energy that it never had
// (Hannaford and Ryu 2002, their E with the force that was held instead of the one to come). F is the force after the
// device took it, `delay_ticks` later where the device says that it takes so long. Exact for a device that then holds
// it. Where positions were missing, the mean of the forces held meanwhile stands for them.
//
// Encoders round, so E follows the position that encoder_position.hpp makes of the readings, x~, which is off by at
// most their resolution Delta along each axis. A contact that begins and ends without force therefore has its energy
// within Delta times the sum of the force's changes along the axes (summation by parts).
//
// Controller. While its account of E is negative it adds a damper, alpha = -E / (T v^2), which takes the missing energy
// back within a tick if v stays, before the gate. v is the servo's velocity estimate, the one that the algorithm damps
// with: the bare difference of the last tick is nearer to what E was made of, but one encoder step in it would be a
// velocity of Delta / T. Known troubles of the method, and what is done here:
//  - alpha has no bound as v goes to 0. The damper is at most `damping_limit`, so its force goes to 0 with v.
//  - force bursts. The added force is at most `force_share` of the force limit; the rest of E is taken back later.
//  - energy credit. What a long damped contact, or friction, took would pay for a later active one. With
//    `forget_credit` (the default) the account's credit is dropped whenever the force held was zero: without contact
//    the environment stores nothing, so what is left was dissipated. Debt stays, and is taken back in free motion too.
//  - a passive device bears more than E says: a real wall within b > K T / 2 of the device's own friction is slightly
//    active by itself (K T / 2 of damping too little), which the controller takes back all the same.
//
// Frame W: world [m, N]. Thread: the servo's. Cost: some 3 ns, with the controller 5 ns. Errors: none. Heap: in
// the constructor.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/vec.hpp"
#include "servo/safety/encoder_position.hpp"

namespace palpate {

struct PassivityParameters {
  bool control = false;  // observe only
  bool forget_credit = true;
  double force_share = 0.25;           // of the force limit, that the controller may add [-]
  double damping_limit_Ns_per_m = 10;  // of the controller's damper [N s/m]
};

class Passivity {
 public:
  // Throws Error(kBadInput) unless share and damping are finite, the share within 0 to 1, damping and delay not
  // negative, and the resolution too.
  Passivity(const PassivityParameters& parameters, double force_limit_N, double rate_hz, int delay_ticks = 0,
            double resolution_m = 0);

  void reset(const Vec3& position_W) noexcept { position_.reset(position_W); }

  // A new position: what the held force did on the way there.
  void moved(const Vec3& position_W) noexcept {
    const Vec3 mean_W = held_count_ > 1 ? Vec3(held_W_ / held_count_) : held_W_;
    const Vec3 last_W = position_.value();
    position_.read(position_W, std::max(1, held_count_));
    const Vec3 way_W = position_.value() - last_W;
    held_count_ = 0;
    if (way_W.cwiseAbs().maxCoeff() <= kLongestWay_m) account(-mean_W.dot(way_W), mean_W);
  }

  // The force that the device was given in this tick, and holds from now on or from `delay_ticks` later.
  void hold(const Vec3& force_W) noexcept {
    if (under_way_W_.empty()) return act(force_W);
    act(under_way_W_[oldest_]);
    under_way_W_[oldest_] = force_W;
    oldest_ = oldest_ + 1 < under_way_W_.size() ? oldest_ + 1 : 0;
  }

  // The controller's force, to be added before the gate; zero where it observes only or nothing is owed [N].
  [[nodiscard]] Vec3 damping(const Vec3& velocity_W) const noexcept {
    if (!control_ || account_J_ >= -kRounding_J) return Vec3::Zero();
    const double speed = velocity_W.stableNorm();
    if (!(speed > 0)) return Vec3::Zero();
    const double wanted = -account_J_ * rate_hz_ / (speed * speed);
    return velocity_W * -std::min({wanted, damping_limit_, force_limit_N_ / speed});
  }

  [[nodiscard]] double energy_J() const noexcept { return energy_J_; }
  [[nodiscard]] double forceBound() const noexcept { return force_limit_N_; }  // of the controller [N]

  // A way from one position to the next that is longer is a wrong reading, not a motion that did work [m].
  static constexpr double kLongestWay_m = 1;
  // Sums of a long run are rounded by less than this: 1e6 ticks of 8 N over 1 mm, each to 1e-16 of itself.
  static constexpr double kRounding_J = 1e-12;

 private:
  void act(const Vec3& force_W) noexcept {
    held_W_ = held_count_ == 0 ? force_W : Vec3(held_W_ + force_W);
    ++held_count_;
  }

  void account(double taken_J, const Vec3& force_W) noexcept {
    energy_J_ += taken_J;
    account_J_ += taken_J;
    if (forget_credit_ && account_J_ > 0 && force_W.isZero(0)) account_J_ = 0;
  }

  bool control_;
  bool forget_credit_;
  double force_limit_N_;
  double damping_limit_;
  double rate_hz_;
  EncoderPosition position_;    // frame W [m]
  Vec3 held_W_ = Vec3::Zero();  // sum of the forces held since then [N]
  int held_count_ = 0;
  std::vector<Vec3> under_way_W_;  // ring of the forces that do not act yet [N]
  std::size_t oldest_ = 0;
  double energy_J_ = 0;   // the observer's E
  double account_J_ = 0;  // the controller's, with credit forgotten
};

}  // namespace palpate
