// SPDX-License-Identifier: Apache-2.0
// servo/safety/passivity.hpp: does the virtual environment give more energy to the hand than it took? A passivity
// observer, and a controller that takes such energy back.
//
// Observer. The device holds the force F of a tick until the next one. So its work on the hand over the tick is exactly
// F . (x_next - x), whatever the motion in between. E is the energy that the environment took so far:
//   E -= F_last . (x - x_last),  E >= 0: passive so far, E < 0: it has given energy that it never took
// (Hannaford and Ryu 2002; their E uses the force to come, this one the force that was held). F is the force that the
// device took. If the device states a delay, F counts from `delay_ticks` later. E is exact for a device that holds F
// over the tick. If positions were missing, the mean of the forces held meanwhile is used.
//
// Encoders round, so E uses the position x~ that encoder_position.hpp makes of the readings. x~ is off by at most the
// resolution Delta along each axis. For a contact that begins and ends without force, E is therefore off by at most
// Delta times the sum of the force's changes along the axes (summation by parts).
//
// Controller. The energy that the contact's springs hold (TickOutput::stored_J) will be given back, and is no credit:
// the account is A = E - stored. While A is negative, the controller adds a damper before the gate: alpha = -A / (T
// v^2). At constant v that takes the missing energy back within a tick. v is the servo's velocity estimate, which the
// algorithm uses for its damping too. The difference of the last two positions would be closer to E, but one encoder
// step would make a velocity of Delta / T. Known troubles of the method, and what is done here:
// - alpha has no bound as v goes to 0. So the damper is at most `damping_limit`, and its force goes to 0 with v. A
//   damper whose force comes later than it brakes the mass shakes by itself (brakingDamping() in hand_dynamics.hpp).
// - Force bursts. The added force is at most `force_share` of the force limit. The rest of E is taken back later.
// - Energy credit. A damped contact, or friction, would build up credit that pays for an active contact later. With
//   `forget_credit` (the default) credit is dropped at once: nothing is stored in it, so it was dissipated. A debt
//   stays, and is taken back in free motion too. If the algorithm does not know what is stored, credit is dropped
//   whenever the force held was zero: without contact nothing is stored. Within a contact the tool may then swing on
//   the credit of its own pressing.
// - A force that is cut to the limit stores less than its spring would: for a spring K d > F_max that is F_max d -
//   F_max^2 / (2 K), or K d^2 / 2 times r (2 - r) with r = F_max / (K d).
// - A passive device can bear more than E says. A real wall that lacks damping by up to K T / 2 is slightly active by
//   itself. It is still stable if the device's own friction b makes up for that (b > K T / 2). The controller takes
//   that energy back all the same.
//
// Frame W: world [m, N]. Thread: the servo's. Cost: some 3 ns, with the controller 5 ns. Errors: none. Heap: in the
// constructor.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "base/vec.hpp"
#include "servo/safety/encoder_position.hpp"

namespace palpate {

struct PassivityParameters {
  bool control = false;  // false: observe only
  bool forget_credit = true;
  double force_share = 0.25;  // the most that the controller may add, as a share of the force limit [-]
  // Of the controller's damper; empty: in a loop what the device bears (servo_loop.cpp), else kUsualDamping [N s/m].
  std::optional<double> damping_limit_Ns_per_m = std::nullopt;

  static constexpr double kUsualDamping_Ns_per_m = 10;
};

// What the springs of a contact hold, and the force that they want. Not finite: unknown.
struct ContactSpring {
  double stored_J = std::numeric_limits<double>::quiet_NaN();
  double wanted_N = 0;
};

class Passivity {
 public:
  // Throws Error(kBadInput) unless share, damping and resolution are finite, the share is within 0 to 1, and damping,
  // delay and resolution are not negative.
  Passivity(const PassivityParameters& parameters, double force_limit_N, double rate_hz, int delay_ticks = 0,
            double resolution_m = 0);

  void reset(const Vec3& position_W) noexcept { position_.reset(position_W); }

  // A new position: counts the work that the held force did over the motion to it.
  void moved(const Vec3& position_W) noexcept {
    const Vec3 mean_W = held_count_ > 1 ? Vec3(held_W_ / held_count_) : held_W_;
    const Vec3 last_W = position_.value();
    position_.read(position_W, std::max(1, held_count_));
    const Vec3 way_W = position_.value() - last_W;
    held_count_ = 0;
    if (way_W.cwiseAbs().maxCoeff() <= kLongestMotion_m) account(-mean_W.dot(way_W), mean_W);
  }

  // The force that the device took in this tick. It acts from now on, or `delay_ticks` later.
  void hold(const Vec3& force_W) noexcept {
    if (under_way_W_.empty()) return act(force_W);
    act(under_way_W_[oldest_]);
    under_way_W_[oldest_] = force_W;
    oldest_ = oldest_ + 1 < under_way_W_.size() ? oldest_ + 1 : 0;
  }

  // The controller's force, to be added before the gate, which cuts to `force_limit_N`. Zero if it only observes or no
  // energy is owed [N].
  [[nodiscard]] Vec3 damping(const Vec3& velocity_W, const ContactSpring& spring = {},
                             double force_limit_N = std::numeric_limits<double>::infinity()) noexcept {
    if (!control_) return Vec3::Zero();
    const bool known = std::isfinite(spring.stored_J);
    const double cut = spring.wanted_N > force_limit_N ? force_limit_N / spring.wanted_N : 1;
    const double stored_J = known ? spring.stored_J * cut * (2 - cut) : 0;
    if (known && forget_credit_) account_J_ = std::min(account_J_, stored_J);
    const double debt_J = stored_J - account_J_;
    if (debt_J <= kRounding_J) return Vec3::Zero();
    const double speed = velocity_W.stableNorm();
    if (!(speed > 0)) return Vec3::Zero();
    const double wanted = debt_J * rate_hz_ / (speed * speed);
    return velocity_W * -std::min({wanted, damping_limit_, share_limit_N_ / speed});
  }

  [[nodiscard]] double energy_J() const noexcept { return energy_J_; }
  [[nodiscard]] double forceBound() const noexcept { return share_limit_N_; }  // of the controller [N]

  // Two successive positions that are farther apart hold a wrong reading, not a motion that did work [m].
  static constexpr double kLongestMotion_m = 1;
  // Bounds the rounding of the sums over a long run: 1e6 ticks of 8 N over 1 mm, each off by 1e-16 of itself.
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
  double share_limit_N_;
  double damping_limit_;
  double rate_hz_;
  EncoderPosition position_;    // frame W [m]
  Vec3 held_W_ = Vec3::Zero();  // sum of the forces held since the last position [N]
  int held_count_ = 0;
  std::vector<Vec3> under_way_W_;  // ring of the forces that do not act yet [N]
  std::size_t oldest_ = 0;
  double energy_J_ = 0;   // the observer's E
  double account_J_ = 0;  // the controller's, with credit forgotten
};

}  // namespace palpate
